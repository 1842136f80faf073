"""Runs of commands that create surfaces: output, dumps, refused input.
Knows nothing of what the commands create."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
from lammps_scripts import HEADER, LMP

MPIEXEC = os.environ.get("BIEM_MPIEXEC", "mpirun")


def read_dump(path):
    lines = Path(path).read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if "ITEM: ATOMS" in line or
                 "ITEM: ENTRIES" in line)
    return np.array([[float(word) for word in line.split()] for line in lines[first + 1:]])


class CreateCase(unittest.TestCase):
    """A folder of its own for each test. Derived classes name the command and the lines that make
    the box, if a test gives no others, and the lines of the output."""

    command = box = output = ""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def run_lammps(self, script, n_ranks=1):
        (self.folder / "in.test").write_text(script)
        command = [LMP, "-in", "in.test", "-log", "log.test"]
        if n_ranks > 1:
            command = [MPIEXEC, "-np", str(n_ranks)] + command
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1",
                           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                           OMPI_MCA_rmaps_base_oversubscribe="1")
        return subprocess.run(command, cwd=self.folder, capture_output=True, text=True,
                              env=environment)

    def run_output(self, commands, n_ranks=1, box=None):
        """Text, and the dumps of atoms and angles."""
        box = self.box if box is None else box
        done = self.run_lammps(HEADER + box + commands + self.output, n_ranks)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-2000:])
        atoms = read_dump(self.folder / "atoms.dump")
        angles = read_dump(self.folder / "angles.dump").astype(int)
        return done.stdout, atoms, angles

    def assert_refused(self, commands, *messages, box=None, header=HEADER, n_ranks=1):
        box = self.box if box is None else box
        done = self.run_lammps(header + box + commands, n_ranks)
        self.assertNotEqual(done.returncode, 0, f"accepted: {commands}")
        text = " ".join((done.stdout + done.stderr).split())
        for message in (self.command,) + messages:
            self.assertIn(message, text, commands)
