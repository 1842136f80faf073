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
    """Rows of the thermo output as dictionaries, by step; of several runs that of the first."""
    rows, header = {}, None
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            header = words
        elif words[:2] == ["Loop", "time"]:
            header = None
        elif header and len(words) == len(header):
            try:
                rows.setdefault(int(words[0]), dict(zip(header, map(float, words))))
            except ValueError:
                pass
    return rows


class Example:
    """An example, its files, and how closely a new run follows the reference logs.

    Thermo prints 8 digits; volume errors are differences of nearly equal numbers.  What a solver
    finds depends on rounding to its tolerance, as the iteration may stop a step earlier or later.
    """

    steps, interval = 4, 2    # of the run, and between two rows of its thermo output
    files = ("cells.data", "cells.dump")
    relative, absolute = 2e-7, 1e-12
    iterations = residual = None    # columns of the solver
    folder = None    # if not that of the example's name

    def run_example(self, folder, n_ranks, output):
        shutil.copy(folder / f"in.{self.example}", output)
        done = subprocess.run(
            [MPIEXEC, "-np", str(n_ranks), LMP, "-in", f"in.{self.example}", "-log", "none",
             "-var", "output_dir", ".", "-var", "steps", str(self.steps)],
            cwd=output, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
        for name in self.files:
            self.assertGreater((Path(output) / name).stat().st_size, 1000, name)
        return read_thermo(done.stdout)

    def check(self, n_ranks):
        folder = SOURCE / "examples" / (self.folder or self.example)
        logs = list(folder.glob(f"log.*.{self.example}.g++.{n_ranks}"))
        self.assertEqual(len(logs), 1)
        reference = read_thermo(logs[0].read_text())
        with tempfile.TemporaryDirectory() as output:
            rows = self.run_example(folder, n_ranks, output)
        self.assertEqual(sorted(rows), list(range(0, self.steps + 1, self.interval)))
        for step, row in rows.items():
            for name, value in row.items():
                if name in TIMES or name == self.residual:
                    continue
                expected = reference[step][name]
                delta = self.relative * abs(expected) + self.absolute
                if name == self.iterations:
                    delta = 2
                self.assertAlmostEqual(value, expected, delta=delta,
                                       msg=f"{name} at step {step}")

    def test_one_processor(self):
        self.check(1)

    def test_two_processors(self):
        self.check(2)


class ShearedSuspension(Example, unittest.TestCase):
    steps = 10    # with a flip of the box
    example = "sheared_suspension"
    files = Example.files + ("cells.table",)


class CoupledExample(Example):
    relative, absolute = 3e-4, 1e-7
    iterations, residual = "f_flow[11]", "f_flow[12]"


class ChannelSmall(CoupledExample, unittest.TestCase):
    example = "channel_small"


class DuctSmall(CoupledExample, unittest.TestCase):
    example = "duct_small"


class BinaryCollision(CoupledExample, unittest.TestCase):
    example = "binary_collision"
    files = ("collision.1.data", "collision.6.dump")


class FlowField(Example, unittest.TestCase):
    steps = 20
    folder, example = "binary_collision", "flow_field"
    files = ("field.data", "field.dump")


class ViscosityRatio(CoupledExample, unittest.TestCase):
    example = "viscosity_ratio"
    files = Example.files + ("cells.table",)


if __name__ == "__main__":
    unittest.main()
