"""Small LAMMPS cases with membranes: data files, runs of lmp_biem and their output.
Knows nothing of what is tested."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE = Path(os.environ.get("BIEM_SOURCE", Path(__file__).resolve().parents[2]))
LMP = os.environ.get("BIEM_LMP", str(SOURCE / "build" / "lmp_biem"))
MPIEXEC = os.environ.get("BIEM_MPIEXEC", "mpiexec")

HEADER = """
units lj
newton on
atom_style molecular
boundary p p p
comm_modify cutoff 1.5
neighbor 0.3 bin
"""

STYLES = """
pair_style zero 1.0
pair_coeff * *
mass * 1.0
angle_style biem/skalak
angle_coeff * 1.0 20.0
dihedral_style biem/bend
dihedral_coeff * 0.05 sphere
"""

READ = """
fix biem_reference all property/atom d2_biem_reference 3 ghost yes
read_data {data} fix biem_reference NULL biem_reference
"""

THERMO = "thermo_style custom step pe {columns}\nthermo_modify norm no format float %.16g\nrun 0\n"


def make_icosphere(n_divisions=2):
    """Unit sphere: 162 nodes and 320 triangles, counter-clockwise from outside, by default."""
    g = (1.0 + np.sqrt(5.0)) / 2.0
    nodes = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
             (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    nodes = [np.array(x) / np.linalg.norm(x) for x in nodes]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                 (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
                 (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(n_divisions):
        middles, finer = {}, []

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                x = nodes[i] + nodes[j]
                nodes.append(x / np.linalg.norm(x))
                middles[key] = len(nodes) - 1
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return np.array(nodes), np.array(triangles)


def make_hinges(triangles):
    """a-b-c-d of every edge b-c: triangles (a,b,c) and (d,c,b)."""
    opposite = {}
    for t in triangles:
        for k in range(3):
            opposite[(t[k], t[(k + 1) % 3])] = t[(k + 2) % 3]
    return [(opposite[b, c], b, c, opposite[c, b]) for b, c in opposite if b < c]


def write_data(path, cells, box=(4.0, 4.0, 4.0), tilt=None, with_reference=True):
    """cells: list of (positions, reference), both of the nodes of make_icosphere()."""
    _, triangles = make_icosphere()
    hinges = make_hinges(triangles)
    n = len(cells[0][0])
    lines = ["membrane cells", "", f"{n * len(cells)} atoms",
             f"{len(triangles) * len(cells)} angles", f"{len(hinges) * len(cells)} dihedrals",
             "1 atom types", "1 angle types", "1 dihedral types", ""]
    lines += [f"0 {box[k]!r} {'xyz'[k]}lo {'xyz'[k]}hi" for k in range(3)]
    if tilt is not None:
        lines.append(f"{tilt[0]!r} {tilt[1]!r} {tilt[2]!r} xy xz yz")

    def section(name, rows):
        lines.extend(["", name, ""] + rows)

    section("Atoms # molecular", [
        f"{m * n + i + 1} {m + 1} 1 " + " ".join(f"{v:.17g}" for v in x)
        for m, (positions, _) in enumerate(cells) for i, x in enumerate(positions)])
    tuples = (("Angles", triangles), ("Dihedrals", hinges))
    for name, items in tuples:
        rows = [[m * n + i + 1 for i in item] for m in range(len(cells)) for item in items]
        section(name, [f"{k + 1} 1 " + " ".join(map(str, row)) for k, row in enumerate(rows)])
    if with_reference:
        section("biem_reference", [
            f"{m * n + i + 1} " + " ".join(f"{v:.17g}" for v in x)
            for m, (_, reference) in enumerate(cells) for i, x in enumerate(reference)])
    Path(path).write_text("\n".join(lines) + "\n")


def run(script, directory, n_ranks=1):
    """Runs the input script; the completed process with all output in .stdout."""
    name = Path(directory) / "in.case"
    name.write_text(script)
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMP_NUM_THREADS="1")
    command = [LMP, "-in", str(name), "-log", "none"]
    if n_ranks > 1:
        environment["OMPI_MCA_rmaps_base_oversubscribe"] = "1"
        command = [MPIEXEC, "-n", str(n_ranks)] + command
    return subprocess.run(command, cwd=directory, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=300)


def read_thermo(output):
    """Rows of all thermo tables, as a list of dictionaries."""
    rows, names = [], None
    for line in output.splitlines():
        words = line.split()
        if words and words[0] == "Step":
            names = words
        elif words and words[0] == "Loop":
            names = None
        elif names and len(words) == len(names) and re.match(r"^-?\d", words[0]):
            rows.append(dict(zip(names, map(float, words))))
    return rows


def run_thermo(script, directory, n_ranks=1):
    result = run(script, directory, n_ranks)
    if result.returncode != 0:
        raise AssertionError(f"lmp_biem ended with {result.returncode}:\n{result.stdout[-3000:]}")
    return read_thermo(result.stdout)


class FolderCase(unittest.TestCase):
    """A folder of its own for each test, with a path for the data file of the cells."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = Path(self._folder.name)
        self.data = self.folder / "cells.data"

    def tearDown(self):
        self._folder.cleanup()

    def expect_error(self, script, *parts, n_ranks=1, folder=None):
        """The script is refused; parts: of the message; a|b: one of the two, where LAMMPS versions
        differ."""
        result = run(script, folder or self.folder, n_ranks)
        self.assertNotEqual(result.returncode, 0, "accepted:\n" + result.stdout[-2000:])
        errors = " ".join(line for line in result.stdout.splitlines() if "ERROR" in line)
        self.assertTrue(errors, "no message:\n" + result.stdout[-2000:])
        for part in parts:
            self.assertTrue(any(word in errors for word in part.split("|")), f"no {part}: {errors}")
