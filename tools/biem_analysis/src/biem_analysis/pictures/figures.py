"""Figures as PNG files: snapshots in time, the last frame, inclination and deformation in time,
profiles across a channel.

Knows files, titles and matplotlib; takes images from the renderer and curves from CellShapes and
CrossProfile.
"""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

DPI = 150
TEXT_COLOR = "#2a2f36"
CURVE_COLOR = "#b3202c"


def make_figure(width, height):
    """A figure of the size in inches, independent of any display."""
    figure = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def draw_axes_cross(figure, camera, labels, corner=(0.055, 0.06), size=0.42):
    """The three directions as seen by the camera, in the lower left corner of the figure."""
    width, height = figure.get_size_inches()
    axes = figure.add_axes([corner[0] - size / width, corner[1] - size / height,
                            2 * size / width, 2 * size / height])
    axes.set_xlim(-1.35, 1.35)
    axes.set_ylim(-1.35, 1.35)
    axes.axis("off")
    for axis, label in enumerate(labels):
        tip = np.array([camera.right[axis], camera.up[axis]])
        axes.annotate("", xy=0.95 * tip, xytext=(0, 0),
                      arrowprops={"arrowstyle": "-|>", "color": TEXT_COLOR, "lw": 1.1,
                                  "shrinkA": 0, "shrinkB": 0})
        axes.text(*(1.25 * tip), label, ha="center", va="center", fontsize=9, color=TEXT_COLOR,
                  style="italic")


def place_image(figure, image, rectangle, title, fontsize=12):
    """Show an image, unscaled in aspect, in a rectangle (left, bottom, width, height)."""
    axes = figure.add_axes(rectangle)
    axes.imshow(image, interpolation="lanczos", aspect="equal")
    axes.axis("off")
    axes.set_title(title, fontsize=fontsize, color=TEXT_COLOR, pad=4)


def format_time(time):
    """Title of a picture."""
    return f"t = {time:.4g}"


def draw_snapshots(renderer, frames, times, path, image_width=900):
    """Panels of the frames (list of int) with their times in one PNG file."""
    camera = renderer.make_camera(image_width)
    columns = 1 if len(frames) == 1 else 2
    rows = (len(frames) + columns - 1) // columns
    panel = 6.0
    high = panel * camera.height / camera.width + 0.32
    figure = make_figure(columns * panel + 0.2, rows * high + 0.1)
    width, height = figure.get_size_inches()
    for k, frame in enumerate(frames):
        row, column = divmod(k, columns)
        place_image(figure, renderer.render(frame, image_width),
                    [(0.1 + column * panel) / width, 1.0 - ((row + 1) * high) / height,
                     panel / width, (high - 0.32) / height], format_time(times[k]))
    draw_axes_cross(figure, camera, "xyz", corner=(0.5 / width, 0.5 / height), size=0.34)
    figure.savefig(path)


def draw_final(renderer, frame, time, path, image_width=1800):
    """One frame as a large PNG file."""
    camera = renderer.make_camera(image_width)
    panel = image_width / DPI
    high = panel * camera.height / camera.width
    figure = make_figure(panel + 0.2, high + 0.5)
    width, height = figure.get_size_inches()
    place_image(figure, renderer.render(frame, image_width),
                [0.1 / width, 0.1 / height, panel / width, high / height], format_time(time),
                fontsize=15)
    draw_axes_cross(figure, camera, "xyz", corner=(0.7 / width, 0.7 / height), size=0.5)
    figure.savefig(path)


def cut_at_right_angle(times, angle):
    """A curve of angles (n,), degrees, cut where it passes from +90 to -90 or back.

    Returns times and angles with the two ends and a gap (NaN) inserted at each passage.
    """
    jumps = np.flatnonzero(np.abs(np.diff(angle)) > 90.0)
    side = np.where(angle[jumps] > 0, 90.0, -90.0)
    rest = side - angle[jumps]
    whole = rest + angle[jumps + 1] + side    # the way through +-90 to the next angle
    share = np.divide(rest, whole, out=np.zeros_like(rest), where=whole != 0)
    passage = times[jumps] + share * (times[jumps + 1] - times[jumps])
    places = np.repeat(jumps + 1, 3)
    ends = np.column_stack([side, np.full_like(side, np.nan), -side]).ravel()
    return np.insert(times, places, np.repeat(passage, 3)), np.insert(angle, places, ends)


def compute_mean_inclination(inclination):
    """Mean over cells (n_frames,) of angles (n_frames, n_cells), degrees, that repeat after 180.

    The mean direction of the doubled angles, so that 89 and -89 average to 90 and not to 0.
    """
    doubled = np.exp(2j * np.radians(inclination)).mean(axis=1)
    return 0.5 * np.degrees(np.angle(doubled))


def style_axes(axes, label):
    """Label and grid of a plot."""
    axes.set_ylabel(label, color=TEXT_COLOR)
    axes.grid(color="#e3e6ea", lw=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(colors=TEXT_COLOR)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_curves(axes, curves, mean):
    """One thin line per cell and their mean; every curve is a pair of times and values."""
    alpha = 0.9 if len(curves) == 1 else max(0.2, 0.8 / np.sqrt(len(curves)))
    for k, (times, values) in enumerate(curves):
        axes.plot(times, values, color=CURVE_COLOR, lw=0.9, alpha=alpha,
                  label=f"single cells (n = {len(curves)})" if k == 0 else None)
    axes.plot(*mean, color=TEXT_COLOR, lw=2.2, label="mean over cells")


def draw_shapes(results, path, shear_plane="xz"):
    """Inclination and Taylor deformation against time; `results` of CellShapes."""
    figure = make_figure(8.0, 6.4)
    upper, lower = figure.subplots(2, 1, sharex=True)
    times, angles = results.times, results.inclination_in_plane
    draw_curves(upper, [cut_at_right_angle(times, column) for column in angles.T],
                cut_at_right_angle(times, compute_mean_inclination(angles)))
    style_axes(upper, f"inclination\nin the {shear_plane} plane (degrees)")
    if np.abs(angles).max() > 60.0:
        upper.set_yticks(np.arange(-90, 91, 30))
    deformation = results.taylor_deformation
    draw_curves(lower, [(times, column) for column in deformation.T],
                (times, deformation.mean(axis=1)))
    style_axes(lower, "Taylor deformation\n(L - B)/(L + B), no unit")
    lower.set_ylim(bottom=0.0)
    lower.set_xlabel("time (time unit of the run)", color=TEXT_COLOR)
    for line in upper.legend(frameon=False, fontsize=9, loc="best").get_lines():
        line.set_alpha(1.0)
    figure.align_ylabels()
    figure.tight_layout()
    figure.savefig(path)


def draw_profile(results, path, axis="z", flow="x"):
    """Velocity and volume fraction across the channel, means over time; of CrossProfile."""
    curves = [("volume_fraction", "volume fraction of cells, no unit")]
    if not np.all(np.isnan(results.velocity)):
        curves.insert(0, ("velocity", f"mean velocity along {flow}\n(velocity unit of the run)"))
    figure = make_figure(4.2 * len(curves), 4.2)
    panels = figure.subplots(1, len(curves), sharey=True, squeeze=False)[0]
    for axes, (name, label) in zip(panels, curves):
        mean = results[name].mean(axis=0)
        if name == "velocity":
            axes.plot(mean, results.centers, color=CURVE_COLOR, lw=1.6, marker="o", ms=3.5)
        else:
            axes.stairs(mean, results.edges, orientation="horizontal", color=CURVE_COLOR, lw=1.6,
                        fill=True, alpha=0.6)
        style_axes(axes, "")
        axes.set_xlabel(label, color=TEXT_COLOR)
        axes.set_xlim(left=min(0.0, np.nanmin(mean)))
    panels[0].set_ylim(results.edges[0], results.edges[-1])
    panels[0].set_ylabel(f"{axis} (length unit of the run)", color=TEXT_COLOR)
    figure.suptitle(f"t = {results.times[0]:.4g} to {results.times[-1]:.4g}", fontsize=11,
                    color=TEXT_COLOR)
    figure.tight_layout()
    figure.savefig(path)
