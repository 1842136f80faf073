"""Figures of flow fields and of paths. Knows files and matplotlib; takes arrays."""

import numpy as np
from matplotlib.collections import LineCollection

from .figures import CURVE_COLOR, TEXT_COLOR, make_figure

PATH_COLORS = ("#b3202c", "#1f5f99", "#d08a1d", "#3f7d44", "#6b4c9a", "#6f6f6f")
ARROWS = 28     # along the longer side


def style_plane(axes, plane):
    """Labels and scale of a picture of a plane."""
    axes.set_aspect("equal")
    axes.set_xlabel("xyz"[plane[0]], color=TEXT_COLOR, style="italic")
    axes.set_ylabel("xyz"[plane[1]], color=TEXT_COLOR, style="italic")
    axes.tick_params(colors=TEXT_COLOR)


def add_outline(axes, outline, plane, **style):
    """Segments (n, 2, 3) of an outline."""
    axes.add_collection(LineCollection(outline[:, :, list(plane)], **style))


def draw_flow_field(field, outline, plane, path):
    """Arrows in the plane over the magnitude of the velocity; outlines of the surfaces.

    Arrows have the square root of the velocity's length, so that weak flow is seen, too.
    """
    first, second = plane
    width, height = np.ptp(field.across), np.ptp(field.upward)
    figure = make_figure(9.0, 9.0 * height / width * 0.86 + 1.0)
    axes = figure.add_subplot()
    speed = np.linalg.norm(field.velocity, axis=2)
    image = axes.pcolormesh(field.across, field.upward, speed, cmap="Blues", shading="gouraud",
                            vmin=0.0, rasterized=True)
    step = max(1, round(max(speed.shape) / ARROWS))
    shown = (slice(step // 2, None, step), slice(step // 2, None, step))
    scale = 1.0 / np.sqrt(np.maximum(speed[shown], 1e-300))
    spacing = step * width / (len(field.across) - 1)
    largest = np.sqrt(np.nanmax(speed))
    axes.quiver(field.across[shown[1]], field.upward[shown[0]],
                field.velocity[shown][..., first] * scale,
                field.velocity[shown][..., second] * scale, color=TEXT_COLOR, angles="xy",
                scale_units="xy", scale=largest / (1.25 * spacing), width=0.0018, pivot="mid")
    add_outline(axes, outline, plane, colors=CURVE_COLOR, linewidths=2.0)
    style_plane(axes, plane)
    bar = figure.colorbar(image, ax=axes, shrink=0.8, pad=0.02)
    bar.set_label("magnitude of the velocity", color=TEXT_COLOR)
    figure.tight_layout()
    figure.savefig(path)


def draw_paths(paths, plane, path, limits=None):
    """Paths in the plane relative to the other surface, whose outlines are shown.

    limits : low and high end of the first axis in the picture, length
    """
    first, second = plane
    ends = np.concatenate([one.offset for one in paths] + [one.outline[:, 0] for one in paths])
    width = np.ptp(ends[:, first] if limits is None else limits)
    figure = make_figure(9.0, max(2.4, 7.0 * np.ptp(ends[:, second]) / width + 1.0))
    axes = figure.add_subplot()
    for k, one in enumerate(paths):
        color = PATH_COLORS[k % len(PATH_COLORS)]
        axes.plot(one.offset[:, first], one.offset[:, second], color=color, lw=1.3,
                  label=f"run {k + 1}")
        add_outline(axes, one.outline, plane, colors=color, linewidths=0.9, alpha=0.7)
    style_plane(axes, plane)
    axes.grid(color="#e3e6ea", lw=0.7)
    axes.set_axisbelow(True)
    if limits is not None:
        axes.set_xlim(*limits)
    axes.legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.tight_layout()
    figure.savefig(path)
