"""Colours of cells and the painted spot that shows their membranes turning.

Knows meshes and positions; knows no camera and no light.
"""

import colorsys
from typing import NamedTuple

import numpy as np

from ..polyhedron import compute_triangle_area

GOLDEN = 0.618034
HUES = ((0.945, 0.115), (0.13, 0.02), (0.55, 0.06))    # first and spread, by kind of cell
SPOT_RADIUS = 0.22    # of a spot, in units of sqrt(cell area / pi)


class Spots(NamedTuple):
    """One painted spot per cell; it is round in the frame of `positions`."""

    positions: np.ndarray    # (n_atoms, 3), length
    nodes: np.ndarray        # (n_cells,), atom index of the middle of each spot
    radius: np.ndarray       # (n_cells,), length

    def compute_paint(self, points, cell):
        """1 - distance/radius of points (n, 3, 3) of the cells `cell` (n,), shape (n, 3).

        The paint ends where it is 0; `points` are where the points were in that frame.
        """
        middle = self.positions[self.nodes[cell]]
        distance = np.linalg.norm(points - middle[:, None], axis=2)
        return 1.0 - distance / self.radius[cell][:, None]


def choose_colors(types):
    """One colour per cell, array (n_cells, 3), RGB in [0, 1]; cells close in number differ well.

    types : int array (n_cells,); the lowest is red, the others have a hue each.
    """
    colors = []
    for cell, kind in enumerate(np.unique(types, return_inverse=True)[1]):
        base, spread = HUES[kind % len(HUES)]
        hue = (base + spread * ((0.13 + GOLDEN * cell) % 1.0)) % 1.0
        saturation = 0.84 - 0.18 * ((0.37 * cell) % 1.0)
        value = 0.74 + 0.22 * ((0.7 * GOLDEN * cell + 0.4) % 1.0)
        colors.append(colorsys.hsv_to_rgb(hue, saturation, value))
    return np.array(colors)


def make_spots(positions, mesh, markers, toward):
    """A spot on each cell between its marker node and the viewer's side.

    A spot at the marker itself would be out of sight half the time.

    Parameters
    ----------
    positions : array (n_atoms, 3), length
    mesh : CellMesh
    markers : int array (n_cells,), atom indices, from CellShapes
    toward : array (3,), unit vector along the vorticity to the viewer
    """
    middle = mesh.mean_over_nodes(positions)
    marker = positions[markers] - middle
    marker /= np.linalg.norm(marker, axis=1)[:, None]
    offset = positions[mesh.nodes] - middle[mesh.node_cell]
    offset /= np.linalg.norm(offset, axis=1)[:, None]
    score = np.einsum("ni,ni->n", offset, (0.75 * marker + 0.66 * toward)[mesh.node_cell])
    order = np.lexsort((score, mesh.node_cell))
    nodes = mesh.nodes[order[np.append(mesh.node_start[1:], len(mesh.nodes)) - 1]]
    area = mesh.sum_over_triangles(compute_triangle_area(positions[mesh.triangles]))
    return Spots(positions, nodes, SPOT_RADIUS * np.sqrt(area / np.pi))
