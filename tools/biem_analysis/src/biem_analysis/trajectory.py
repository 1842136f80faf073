"""Makes an MDAnalysis Universe from a LAMMPS data file and a dump of unwrapped positions."""

import io
import warnings

import MDAnalysis
import numpy as np
from MDAnalysis.lib.util import NamedStream

from .data_file import extract_topology
from .dump_reader import BiemDumpReader
from .errors import BiemAnalysisError


def universe(data_file, dump_file, dt=1.0):
    """Universe of a run with cells.

    Parameters
    ----------
    data_file : str
        LAMMPS data file, best written with `write_data cells.data nocoeff nofix`; sections that
        MDAnalysis does not know are skipped
    dump_file : str
        dump with at least the columns id xu yu zu, of the same atoms
    dt : float
        time step of the run (LAMMPS command `timestep`), time unit of the run

    Returns
    -------
    MDAnalysis.Universe
        triangles are `angles`, hinges are `dihedrals`, molecule ids are `resids`.  MDAnalysis may
        reverse the node order of an angle, so it does not keep which side is outside; CellMesh
        finds this again.  `trajectory.ts.data['positions']` holds float64 positions.
    """
    text, atom_columns = extract_topology(str(data_file))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")    # about units and masses, which are not used here
        try:
            result = MDAnalysis.Universe(
                NamedStream(io.StringIO(text), "cells.data"), topology_format="DATA",
                format="DATA", atom_style=atom_columns)
        except (ValueError, KeyError, IndexError, TypeError) as error:
            raise BiemAnalysisError(
                f"data file '{data_file}' cannot be read: {error}; write it again with "
                "'write_data cells.data nocoeff nofix'") from error
    reader = BiemDumpReader(str(dump_file), timestep=dt)
    if not np.array_equal(reader.ids, result.atoms.ids):
        raise BiemAnalysisError(
            f"'{dump_file}' and '{data_file}' hold different atoms: {len(reader.ids)} and "
            f"{len(result.atoms)}, or other ids; dump the group 'all' of the same run")
    result.trajectory = reader
    return result


def get_positions(timestep):
    """Positions of a frame, float64 (n_atoms, 3), length; exact where the reader keeps them."""
    positions = timestep.data.get("positions")
    return timestep.positions.astype(float) if positions is None else positions


def get_box(timestep):
    """Box of a frame: matrix (3, 3) whose rows are the edges, and lower corner (3,), length."""
    if "box" in timestep.data:
        return timestep.data["box"], timestep.data["origin"]
    return timestep.triclinic_dimensions.astype(float), np.zeros(3)
