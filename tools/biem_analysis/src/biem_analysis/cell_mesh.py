"""The triangulated surfaces of a Universe: which nodes and triangles make which cell.

Knows topology and which side is outside; does not know shapes in time.
"""

import numpy as np

from .errors import BiemAnalysisError
from .trajectory import get_positions


def select_types(universe, types):
    """Mask (n_atoms,) of the atoms of some types (list of int)."""
    found = np.asarray(universe.atoms.types).astype(int)
    missing = sorted(set(types) - set(found.tolist()))
    if missing:
        raise BiemAnalysisError(f"there is no atom of type {missing[0]}; there are "
                                f"{' '.join(map(str, np.unique(found)))}")
    return np.isin(found, types)


class CellMesh:
    """Closed surfaces, one per cell, with triangles ordered counter-clockwise from outside.

    Parameters
    ----------
    universe : MDAnalysis.Universe
    types : list of int, optional, atom types of the cells; default: all atoms with triangles.
        Walls are not closed and must be left out.

    Attributes
    ----------
    molecules : int array (n_cells,), molecule id of each cell, ascending
    types : int array (n_cells,), atom type of each cell
    triangles : int array (n_triangles, 3), atom indices, sorted by cell
    triangle_cell : int array (n_triangles,), index of the cell of each triangle
    triangle_start : int array (n_cells,), first triangle of each cell
    nodes : int array (n_nodes,), atom indices, sorted by cell
    node_cell, node_start : as for triangles
    """

    def __init__(self, universe, types=None):
        triangles = np.asarray(universe.angles.indices, dtype=np.int64).reshape(-1, 3)
        if types is not None:
            triangles = triangles[select_types(universe, types)[triangles].all(axis=1)]
        if len(triangles) == 0:
            chosen = "" if types is None else " of the chosen atom types"
            raise BiemAnalysisError(f"the data file has no triangles (LAMMPS angles){chosen}, so "
                                    "there are no cells; write it after create_cells")
        molecule = universe.atoms.resids[triangles]
        mixed = np.flatnonzero(np.any(molecule != molecule[:, :1], axis=1))
        if len(mixed):
            raise BiemAnalysisError(
                f"a triangle connects molecules {sorted(set(molecule[mixed[0]].tolist()))}; every "
                "cell must have its own molecule id (create_cells sets it)")
        order = np.argsort(molecule[:, 0], kind="stable")
        self.triangles = triangles[order]
        self.molecules, self.triangle_start, self.triangle_cell = np.unique(
            molecule[order, 0], return_index=True, return_inverse=True)
        self._collect_nodes()
        self.types = np.asarray(universe.atoms.types).astype(int)[self.nodes[self.node_start]]
        self._orient(get_positions(universe.trajectory.ts))

    @property
    def n_cells(self):
        """Number of cells."""
        return len(self.molecules)

    def sum_over_triangles(self, values):
        """Sums of per-triangle values (n_triangles, ...) per cell, shape (n_cells, ...)."""
        return np.add.reduceat(values, self.triangle_start, axis=0)

    def mean_over_nodes(self, positions):
        """Mean node position of each cell; positions (n_atoms, 3) -> (n_cells, 3), length."""
        sums = np.add.reduceat(positions[self.nodes], self.node_start, axis=0)
        return sums / np.bincount(self.node_cell)[:, None]

    def _collect_nodes(self):
        pairs = np.unique(np.column_stack(
            [np.repeat(self.triangle_cell, 3), self.triangles.ravel()]), axis=0)
        self.node_cell, self.nodes = pairs[:, 0], pairs[:, 1]
        self.node_start = np.searchsorted(self.node_cell, np.arange(self.n_cells))

    def _find_neighbors(self):
        """Across each edge: neighbor triangle, and whether both run along it the same way."""
        begin, end = self.triangles.ravel(), np.roll(self.triangles, -1, axis=1).ravel()
        low, high = np.minimum(begin, end), np.maximum(begin, end)
        order = np.lexsort((high, low))
        edges = np.column_stack([low, high])[order]
        _, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
        if np.any(count != 2):
            bad = order[first[np.argmax(count != 2)]] // 3
            raise BiemAnalysisError(
                f"the surface of molecule {self.molecules[self.triangle_cell[bad]]} is not "
                "closed: an edge belongs to one triangle or to more than two; the data file may "
                "lack triangles, or this is a wall: name the atom types of the cells (--types)")
        one, other = order[0::2], order[1::2]
        neighbor = np.empty(len(begin), dtype=np.int64)
        neighbor[one], neighbor[other] = other // 3, one // 3
        opposed = np.empty(len(begin), dtype=bool)
        opposed[one] = opposed[other] = begin[one] == begin[other]
        return neighbor.reshape(-1, 3), opposed.reshape(-1, 3)

    def _orient(self, positions):
        """Order the nodes of every triangle so that its normal points outward."""
        neighbor, opposed = self._find_neighbors()
        reverse = np.zeros(len(self.triangles), dtype=bool)
        visited = np.zeros(len(self.triangles), dtype=bool)
        front = self.triangle_start
        visited[front] = True
        while len(front):
            found, source = np.unique(neighbor[front].ravel(), return_index=True)
            state = (reverse[front][:, None] ^ opposed[front]).ravel()[source]
            fresh = ~visited[found]
            front = found[fresh]
            reverse[front] = state[fresh]
            visited[front] = True
        wrong = ~visited | np.any((reverse[:, None] ^ reverse[neighbor]) != opposed, axis=1)
        if np.any(wrong):
            cell = self.triangle_cell[np.argmax(wrong)]
            raise BiemAnalysisError(
                f"the triangles of molecule {self.molecules[cell]} are not one orientable closed "
                "surface; every cell must have its own molecule id")
        self.triangles[reverse] = self.triangles[reverse][:, ::-1]
        vertices = positions[self.triangles] - self.mean_over_nodes(
            positions)[self.triangle_cell][:, None, :]
        volume = self.sum_over_triangles(np.linalg.det(vertices))
        inward = volume[self.triangle_cell] < 0
        self.triangles[inward] = self.triangles[inward][:, ::-1]
