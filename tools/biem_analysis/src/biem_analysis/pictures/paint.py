"""Colours of cells and the painted spot that shows their membranes turning.

Knows meshes and positions; knows no camera and no light.
"""

import colorsys

import numpy as np

GOLDEN = 0.618034
SPOT_RADIUS = 0.17    # of a spot, in units of sqrt(cell area / pi)


def choose_colors(n_cells):
    """One red per cell, array (n_cells, 3), RGB in [0, 1]; cells close in number differ well."""
    colors = []
    for cell in range(n_cells):
        hue = (0.945 + 0.115 * ((0.13 + GOLDEN * cell) % 1.0)) % 1.0
        saturation = 0.84 - 0.18 * ((0.37 * cell) % 1.0)
        value = 0.74 + 0.22 * ((0.7 * GOLDEN * cell + 0.4) % 1.0)
        colors.append(colorsys.hsv_to_rgb(hue, saturation, value))
    return np.array(colors)


def choose_spots(positions, mesh, markers, toward):
    """The node in the middle of each cell's spot: between its marker node and the viewer's side.

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
    return mesh.nodes[order[np.append(mesh.node_start[1:], len(mesh.nodes)) - 1]]


def compute_paint(positions, mesh, spots, area):
    """How much paint each atom carries, array (n_atoms,) in [0, 1].

    positions : array (n_atoms, 3) of the frame in which the spots are round, length
    spots : int array (n_cells,), atom indices
    area : array (n_cells,), area of the cells, length^2
    """
    paint = np.zeros(len(positions))
    distance = np.linalg.norm(positions[mesh.nodes] - positions[spots[mesh.node_cell]], axis=1)
    radius = SPOT_RADIUS * np.sqrt(area / np.pi)
    paint[mesh.nodes] = np.clip(1.6 - distance / radius[mesh.node_cell], 0.0, 1.0)
    return paint
