"""The examples run and give what their reference logs say, on one and two processors."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ.get("BIEM_SOURCE", Path(__file__).resolve().parents[2]))
LMP = os.environ.get("BIEM_LMP", str(SOURCE / "build" / "lmp_biem"))
MPIEXEC = os.environ.get("BIEM_MPIEXEC", "mpiexec")

# Columns that say how long a run took.
TIMES = ("CPU", "CPULeft", "v_percent")


def read_thermo(text):
    """Rows of the thermo output as dictionaries, by step."""
    rows, header = {}, None
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            header = words
        elif words[:2] == ["Loop", "time"]:
            header = None
        elif header and len(words) == len(header):
            try:
                rows[int(words[0])] = dict(zip(header, map(float, words)))
            except ValueError:
                pass
    return rows


class ShearedSuspension(unittest.TestCase):
    example, steps = "sheared_suspension", 100

    def check(self, n_ranks):
        folder = SOURCE / "examples" / self.example
        logs = list(folder.glob(f"log.*.{self.example}.g++.{n_ranks}"))
        self.assertEqual(len(logs), 1)
        reference = read_thermo(logs[0].read_text())
        with tempfile.TemporaryDirectory() as output:
            shutil.copy(folder / f"in.{self.example}", output)
            done = subprocess.run(
                [MPIEXEC, "-np", str(n_ranks), LMP, "-in", f"in.{self.example}", "-log", "none",
                 "-var", "output_dir", ".", "-var", "steps", str(self.steps)],
                cwd=output, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
            for name in ("cells.data", "cells.dump", "cells.table"):
                self.assertGreater((Path(output) / name).stat().st_size, 1000, name)
        rows = read_thermo(done.stdout)
        self.assertEqual(sorted(rows), [0, 50, 100])
        for step, row in rows.items():
            for name, value in row.items():
                if name in TIMES:
                    continue
                expected = reference[step][name]
                # printed with 8 digits; volume errors are differences of nearly equal numbers
                self.assertAlmostEqual(value, expected, delta=2e-7 * abs(expected) + 1e-12,
                                       msg=f"{name} at step {step}")

    def test_one_processor(self):
        self.check(1)

    def test_two_processors(self):
        self.check(2)


if __name__ == "__main__":
    unittest.main()
