"""Exact moments of the solids and surfaces that flat triangles bound, many cells at once.

Knows nothing of MDAnalysis, time or flow.  Sources: divergence theorem on the tetrahedra
(origin, a, b, c); moments of a simplex, e.g. Tonon, J. Math. Stat. 1 (2005) 8, by its vertices.
"""

from typing import NamedTuple

import numpy as np


class CellMoments(NamedTuple):
    """Moments of n cells.  For flat triangles they are exact up to rounding (1e-13 relative).

    As moments of the smooth surface whose nodes are given they have an error of order h^2
    (h = edge length): for a sphere of 642 nodes the volume is 0.9 % too small.
    """

    volume: np.ndarray            # (n,), length^3, enclosed by the outward oriented triangles
    centroid: np.ndarray          # (n, 3), length, of the enclosed solid
    covariance: np.ndarray        # (n, 3, 3), length^2, mean of r r over the solid
    area: np.ndarray              # (n,), length^2
    surface_covariance: np.ndarray    # (n, 3, 3), length^2, mean of r r over the surface
    triangle_area: np.ndarray     # (n_triangles,), length^2


def compute_triangle_area(vertices):
    """Areas (n_triangles,) of triangles with vertices (n_triangles, 3, 3)."""
    edges = vertices[:, 1:] - vertices[:, :1]
    return 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)


def compute_cell_moments(vertices, triangle_start, triangle_cell, near):
    """Moments of closed surfaces.

    Parameters
    ----------
    vertices : array (n_triangles, 3, 3), length; [triangle, node, component], sorted by cell
    triangle_start : int array (n,), first triangle of each cell
    triangle_cell : int array (n_triangles,), cell of each triangle
    near : array (n, 3), any point near each cell; keeps rounding errors small far from 0

    Returns
    -------
    CellMoments
    """
    local = vertices - near[triangle_cell][:, None, :]
    vertex_sum = local.sum(axis=1)
    outer = (np.einsum("tvi,tvj->tij", local, local)
             + np.einsum("ti,tj->tij", vertex_sum, vertex_sum))

    def compute_mean(weight, first, second):
        total = np.add.reduceat(weight, triangle_start)
        mean = np.add.reduceat(weight[:, None] * first, triangle_start) / total[:, None]
        square = np.add.reduceat(weight[:, None, None] * second, triangle_start)
        square = square / total[:, None, None]
        return total, mean, square - np.einsum("ni,nj->nij", mean, mean)

    solid = compute_mean(np.linalg.det(local) / 6.0, vertex_sum / 4.0, outer / 20.0)
    triangle_area = compute_triangle_area(local)
    shell = compute_mean(triangle_area, vertex_sum / 3.0, outer / 12.0)
    return CellMoments(solid[0], solid[1] + near, solid[2], shell[0], shell[2], triangle_area)


def compute_volume_below(vertices, heights, axis, levels):
    """Volume below planes of the solids that closed surfaces bound, summed over the solids.

    Divergence theorem with the field min(height, level) along the axis, which is linear in each
    triangle but for the part above the plane, a triangle or what one leaves.

    Parameters
    ----------
    vertices : array (n_triangles, 3, 3), length
    heights : array (n_triangles, 3), length, coordinate of the vertices along `axis`, perhaps
        shifted by cell
    axis : int (0..2)
    levels : array (n,), length, coordinates of the planes

    Returns
    -------
    array (n,), length^3
    """
    edges = vertices[:, 1:] - vertices[:, :1]
    projected = 0.5 * np.cross(edges[:, 0], edges[:, 1])[:, axis]
    ordered = np.sort(heights, axis=1).T
    rise, step, drop = ordered[1] - ordered[0], ordered[2] - ordered[0], ordered[2] - ordered[1]
    tip_scale, rest_scale = (np.maximum(3.0 * step * side, 1e-300) for side in (drop, rise))
    mean = heights.mean(axis=1)
    volume = np.zeros(len(levels))
    for k, level in enumerate(levels):
        low, middle, high = ordered - level
        tip = np.maximum(high, 0.0) ** 3 / tip_scale    # one vertex above
        rest = mean - level + np.maximum(-low, 0.0) ** 3 / rest_scale
        above = np.where(low >= 0.0, mean - level, np.where(middle > 0.0, rest, tip))
        volume[k] = projected @ (mean - np.where(high > 0.0, above, 0.0))
    return volume


def compute_semi_axes(covariance):
    """Semi-axes (n, 3), longest first, of the ellipsoids of the same moments, length.

    A homogeneous ellipsoid of semi-axis a has mean x^2 = a^2/5 along it.
    """
    return np.sqrt(5.0 * np.maximum(np.linalg.eigvalsh(covariance)[:, ::-1], 0.0))


def compute_cell_axis(surface_covariance):
    """Unit vectors (n, 3): eigenvector of the smallest moment of inertia of the surface.

    The inertia tensor is tr(C) I - C, so this is the eigenvector of the largest eigenvalue of
    C = mean of r r over the surface.  Definition: Zhao et al. 2012, Sec. III.  The sign is such
    that the largest component is positive.
    """
    axis = np.linalg.eigh(surface_covariance)[1][:, :, -1]
    largest = np.take_along_axis(axis, np.abs(axis).argmax(axis=1)[:, None], axis=1)
    return axis * np.sign(largest)


def compute_plane_angle(tensor, flow, gradient):
    """Inclination (n,) of the longest direction of second moments (n, 3, 3) in the shear plane.

    Degrees in (-90, 90], from the flow axis toward the gradient axis (0..2), of the eigenvector
    of the larger eigenvalue of the 2 x 2 block.
    """
    difference = tensor[:, flow, flow] - tensor[:, gradient, gradient]
    return 0.5 * np.degrees(np.arctan2(2.0 * tensor[:, flow, gradient], difference))


class EllipseCut(NamedTuple):
    """Cut of the equivalent ellipsoid with the shear plane through its center."""

    angle: np.ndarray         # (n,), degrees in (-90, 90], of the long axis from the flow
    long_axis: np.ndarray     # (n,), length, semi-axis
    short_axis: np.ndarray    # (n,), length, semi-axis

    @property
    def taylor_deformation(self):
        """(long - short) / (long + short), shape (n,)."""
        return (self.long_axis - self.short_axis) / (self.long_axis + self.short_axis)


def compute_ellipse_cut(covariance, flow, gradient):
    """Cut of the ellipsoid x (5 C)^-1 x = 1 with the plane of the axes `flow` and `gradient`.

    Parameters
    ----------
    covariance : array (n, 3, 3), C, length^2, mean of r r over the solid
    """
    inverse = np.linalg.inv(5.0 * covariance)
    xx, zz = inverse[:, flow, flow], inverse[:, gradient, gradient]
    middle, spread = 0.5 * (xx + zz), np.hypot(0.5 * (xx - zz), inverse[:, flow, gradient])
    return EllipseCut(compute_plane_angle(-inverse, flow, gradient),
                      1.0 / np.sqrt(middle - spread), 1.0 / np.sqrt(middle + spread))
