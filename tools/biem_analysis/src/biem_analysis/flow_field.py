"""Velocities on a plane lattice of points, and the outlines of surfaces in a plane.

Pure functions on arrays; knows nothing of files or MDAnalysis.
"""

from typing import NamedTuple

import numpy as np

from .errors import BiemAnalysisError


class PlaneField(NamedTuple):
    """Velocities on the points of a lattice in a plane."""

    across: np.ndarray      # (n,), length, coordinates along the first axis of the plane
    upward: np.ndarray      # (m,), length, along the second axis
    level: float            # length, coordinate normal to the plane
    velocity: np.ndarray    # (m, n, 3), NaN where there is no point


def make_plane_field(points, velocity, first, second):
    """PlaneField of points (n, 3) with velocities (n, 3) in the plane of the axes first, second.

    The points may have any order, and the lattice may have holes.
    """
    normal = 3 - first - second
    if len(points) == 0:
        raise BiemAnalysisError("there are no points of the flow: every atom is a node of a "
                                "surface; put fixed points in a plane and name them as probes in "
                                "fix biem")
    size = np.ptp(points, axis=0).max()
    if np.ptp(points[:, normal]) > 1e-6 * size:
        raise BiemAnalysisError(
            f"the points of the flow are not in one plane: their {'xyz'[normal]} differs by "
            f"{np.ptp(points[:, normal]):g}; give the plane with --shear-plane")
    axes, places = zip(*(find_coordinates(points[:, axis], 1e-6 * size)
                         for axis in (first, second)))
    if len(axes[0]) * len(axes[1]) > 4 * len(points) or min(map(len, axes)) < 2:
        raise BiemAnalysisError(
            f"the {len(points)} points of the flow are not on a lattice: they have "
            f"{len(axes[0])} and {len(axes[1])} different coordinates")
    field = np.full((len(axes[1]), len(axes[0]), 3), np.nan)
    field[places[1], places[0]] = velocity
    return PlaneField(axes[0], axes[1], float(points[:, normal].mean()), field)


def find_coordinates(values, tolerance):
    """Different values, ascending, and the index of each value among them."""
    order = np.argsort(values)
    index = np.concatenate([[0], np.cumsum(np.diff(values[order]) > tolerance)])
    found = np.empty(len(values), dtype=int)
    found[order] = index
    return np.bincount(index, values[order]) / np.bincount(index), found


def cut_surface(vertices, axis, level):
    """Where triangles meet the plane at `level` along `axis`.

    Parameters
    ----------
    vertices : array (n_triangles, 3, 3), length

    Returns
    -------
    array (n, 2, 3), length: a segment for each triangle that crosses the plane
    """
    height = vertices[:, :, axis] - level
    above = height > 0.0
    crossing = above.any(axis=1) & ~above.all(axis=1)
    vertices, height, above = vertices[crossing], height[crossing], above[crossing]
    # The corner that is alone on its side; the plane cuts its two edges.
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    row = np.arange(len(vertices))
    segments = np.empty((len(vertices), 2, 3))
    for k in (1, 2):
        other = (alone + k) % 3
        share = height[row, alone] / (height[row, alone] - height[row, other])
        step = vertices[row, other] - vertices[row, alone]
        segments[:, k - 1] = vertices[row, alone] + share[:, None] * step
    return segments
