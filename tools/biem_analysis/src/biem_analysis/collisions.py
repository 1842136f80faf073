"""Paths of one surface relative to another one, for several runs.

Knows CellShapes and tables; knows no figures.
"""

import csv
from typing import NamedTuple

import numpy as np

from .cell_shapes import CellShapes
from .errors import BiemAnalysisError
from .flow_field import cut_surface
from .trajectory import get_positions, universe


class Path(NamedTuple):
    """How a surface moves relative to another one."""

    times: np.ndarray       # (n_frames,), time
    offset: np.ndarray      # (n_frames, 3), length, between the centroids
    outline: np.ndarray     # (n, 2, 3), length: cut of the other one, at the nearest approach,
                            # with the plane through its centroid, relative to the centroid


def find_cell(shapes, molecule):
    """Index of a molecule among the cells."""
    found = np.flatnonzero(shapes.mesh.molecules == molecule)
    if len(found) == 0:
        raise BiemAnalysisError(f"there is no surface of molecule {molecule}; there are "
                                f"{shapes.mesh.molecules.tolist()}")
    return int(found[0])


def compute_path(data, dump, timestep, molecules, shear_plane="xz"):
    """Path of the first molecule relative to the second one in a run."""
    system = universe(data, dump, dt=timestep)
    shapes = CellShapes(system, shear_plane=shear_plane).run()
    moving, other = (find_cell(shapes, molecule) for molecule in molecules)
    centroid = shapes.results.centroid
    offset = centroid[:, moving] - centroid[:, other]
    nearest = int(np.argmin(np.linalg.norm(offset, axis=1)))
    positions = get_positions(system.trajectory[nearest])
    vertices = positions[shapes.mesh.triangles[shapes.mesh.triangle_cell == other]]
    normal = 3 - "xyz".index(shear_plane[0]) - "xyz".index(shear_plane[1])
    outline = cut_surface(vertices - centroid[nearest, other], normal, 0.0)
    return Path(shapes.results.times, offset, outline)


def write_paths(paths, path):
    """Table (CSV): run (from 1), time, offset x, y, z."""
    with open(path, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["run", "time", "offset_x", "offset_y", "offset_z"])
        for run, one in enumerate(paths, start=1):
            for time, offset in zip(one.times, one.offset):
                writer.writerow([run] + [f"{value:.9g}" for value in (time, *offset)])
