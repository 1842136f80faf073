"""Curved triangles for drawing: a coarse mesh gets a smooth outline, its nodes stay in place.

Knows points and normals only.  Method: point-normal triangles, Vlachos, Peters, Boyd & Mitchell,
Proc. Interactive 3D Graphics (2001) 159, with linearly interpolated normals.
"""

import numpy as np


def make_barycentric_grid(n_parts):
    """Corners of the n_parts^2 equal parts of a triangle, array (n_parts^2, 3, 3).

    [part, corner, barycentric coordinate], in the triangle's own sense of rotation.
    """
    def corner(i, j):
        return (n_parts - i - j, i, j)

    parts = []
    for i in range(n_parts):
        for j in range(n_parts - i):
            parts.append([corner(i, j), corner(i + 1, j), corner(i, j + 1)])
            if i + j < n_parts - 1:
                parts.append([corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)])
    return np.array(parts, dtype=float) / n_parts


def compute_edge_point(begin, end, normal):
    """Control point next to `begin` on the edge to `end`, in the plane normal to `normal`."""
    height = np.einsum("ti,ti->t", end - begin, normal)
    return (2.0 * begin + end - height[:, None] * normal) / 3.0


def evaluate_patches(corner, normal, grid):
    """Points of the cubic patches over triangles.

    Parameters
    ----------
    corner, normal : arrays (n, 3, 3), [triangle, node, component]
    grid : array (m, 3), barycentric coordinates

    Returns
    -------
    array (n, m, 3)
    """
    w = grid.T
    points = sum(np.multiply.outer(corner[:, k], w[k] ** 3) for k in range(3))
    edge_sum = np.zeros_like(corner[:, 0])
    for i in range(3):
        for j in range(3):
            if i != j:
                control = compute_edge_point(corner[:, i], corner[:, j], normal[:, i])
                points += np.multiply.outer(control, 3.0 * w[i] ** 2 * w[j])
                edge_sum += control
    middle = edge_sum / 4.0 - corner.sum(axis=1) / 6.0    # E + (E - V)/2
    points += np.multiply.outer(middle, 6.0 * w[0] * w[1] * w[2])
    return np.swapaxes(points, 1, 2)


def refine(corner, normal, n_parts):
    """Replace each triangle by n_parts^2 flat ones on its curved patch.

    Parameters
    ----------
    corner, normal : arrays (n, 3, 3), [triangle, node, component]; normals of length 1

    Returns
    -------
    corners, normals : arrays (n * n_parts^2, 3, 3), the parts of a triangle one after another
    """
    grid = make_barycentric_grid(n_parts)
    points = evaluate_patches(corner, normal, grid.reshape(-1, 3))
    normals = np.einsum("pck,tki->tpci", grid, normal)
    normals /= np.linalg.norm(normals, axis=-1)[..., None]
    return points.reshape(-1, 3, 3), normals.reshape(-1, 3, 3)
