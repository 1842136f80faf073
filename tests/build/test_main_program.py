"""The program lmp_biem around the styles: its help, its exit status, styles after `clear`."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ.get("BIEM_SOURCE", Path(__file__).resolve().parents[2]))
LMP = os.environ.get("BIEM_LMP", str(SOURCE / "build" / "lmp_biem"))
MPIEXEC = os.environ.get("BIEM_MPIEXEC", "mpiexec")

BOX = """
units lj
atom_style molecular
region box block 0 9 0 9 0 9
create_box 1 box angle/types 1 dihedral/types 1
"""
STYLES = "angle_style biem/skalak\ndihedral_style biem/bend\n"


def run(script, n_ranks=1):
    """Exit status and output of lmp_biem on an input script."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "in.case"
        path.write_text(script)
        done = subprocess.run([MPIEXEC, "-n", str(n_ranks), LMP, "-in", str(path), "-log", "none"],
                              cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class MainProgram(unittest.TestCase):
    def test_help_names_every_style(self):
        done = subprocess.run([LMP, "-h"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        styles = (SOURCE / "src" / "USER-BIEM" / "biem_lammps_styles.h").read_text()
        names = re.findall(r'^  STYLE\(\w+, "([^"]+)"', styles, re.MULTILINE)
        self.assertGreater(len(names), 3)
        for name in names:
            self.assertIn(name, done.stdout)

    def test_success_is_exit_status_zero(self):
        for n_ranks in (1, 2):
            status, output = run(BOX + STYLES, n_ranks)
            self.assertEqual(status, 0, output)

    def test_error_is_another_exit_status(self):
        for n_ranks in (1, 2):
            status, output = run(BOX + "angle_style biem/nonsense\n", n_ranks)
            self.assertNotEqual(status, 0)
            self.assertIn("biem/nonsense", output)

    def test_styles_are_there_after_clear(self):
        status, output = run(BOX + STYLES + "clear\n" + BOX + STYLES + "print 'after clear'\n")
        self.assertEqual(status, 0, output)
        self.assertIn("after clear", output)


if __name__ == "__main__":
    unittest.main()
