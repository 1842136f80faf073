"""Shapes, profiles and pictures of cells: analysis of USER-BIEM trajectories on MDAnalysis.

A cell is a closed triangulated surface: nodes = atoms, triangles = angles, cells = molecules.
All lengths are in the LAMMPS length unit of the run, all times in its time unit.
"""

import warnings

with warnings.catch_warnings(record=True):    # MDAnalysis shows deprecations of its own imports
    import MDAnalysis    # noqa: F401

from .cell_mesh import CellMesh
from .cell_shapes import CellShapes
from .cross_profile import CrossProfile
from .errors import BiemAnalysisError
from .trajectory import universe
from .version import __version__

__all__ = ["BiemAnalysisError", "CellMesh", "CellShapes", "CrossProfile",
           "universe", "__version__"]
