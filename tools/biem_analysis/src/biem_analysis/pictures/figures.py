"""Figures as PNG files: snapshots in time, the last frame, inclination and deformation in time.

Knows files, titles and matplotlib; takes images from the renderer and curves from CellShapes.
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


def break_jumps(angle):
    """Curve with a gap where the angle, degrees, jumps through +-90."""
    broken = angle.copy()
    broken[1:][np.abs(np.diff(angle)) > 90.0] = np.nan
    return broken


def compute_mean_inclination(inclination):
    """Mean over cells (n_frames,) of angles (n_frames, n_cells), degrees, that repeat after 180.

    The mean direction of the doubled angles, so that 89 and -89 average to 90 and not to 0.
    """
    doubled = np.exp(2j * np.radians(inclination)).mean(axis=1)
    return 0.5 * np.degrees(np.angle(doubled))


def draw_curves(axes, times, values, mean, label):
    """One thin line per cell and their mean."""
    n_cells = values.shape[1]
    shade = 0.9 if n_cells == 1 else max(0.18, 0.6 / np.sqrt(n_cells))
    for cell in range(n_cells):
        axes.plot(times, values[:, cell], color=CURVE_COLOR, lw=0.8, alpha=shade,
                  label=f"single cells (n = {n_cells})" if cell == 0 else None)
    axes.plot(times, mean, color=TEXT_COLOR, lw=2.2, label="mean over cells")
    axes.set_ylabel(label, color=TEXT_COLOR)
    axes.grid(color="#e3e6ea", lw=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(colors=TEXT_COLOR)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_shapes(results, path, shear_plane="xz"):
    """Inclination and Taylor deformation against time; `results` of CellShapes."""
    figure = make_figure(8.0, 6.4)
    upper, lower = figure.subplots(2, 1, sharex=True)
    lines = np.apply_along_axis(break_jumps, 0, results.inclination_in_plane)
    mean = break_jumps(compute_mean_inclination(results.inclination_in_plane))
    draw_curves(upper, results.times, lines, mean,
                f"inclination in the {shear_plane} plane (degrees)")
    draw_curves(lower, results.times, results.taylor_deformation,
                results.taylor_deformation.mean(axis=1),
                "Taylor deformation (L - B)/(L + B), no unit")
    lower.set_ylim(bottom=0.0)
    lower.set_xlabel("time (time unit of the run)", color=TEXT_COLOR)
    for line in upper.legend(frameon=False, fontsize=9, loc="upper right").get_lines():
        line.set_alpha(1.0)
    figure.align_ylabels()
    figure.tight_layout()
    figure.savefig(path)
