"""Spherical Skalak capsules in shear against an independent spectral code
(tests/reference/capsule_in_shear.csv): steady Taylor deformation and inclination."""

import csv
import unittest

from lammps_scripts import SOURCE
from single_cell import CAPSULE, average, run_single_cell


def read_reference():
    path = SOURCE / "tests" / "reference" / "capsule_in_shear.csv"
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return {(float(r["Ca"]), float(r["C"])): r for r in csv.DictReader(lines)}


def run_capsule(Ca, C, nodes, timestep, **options):
    return average(run_single_cell("sphere radius 1", nodes, ES=1 / Ca, ED=2 * C / Ca, EB=0.0,
                                   timestep=timestep, duration=8.0, columns=CAPSULE,
                                   **options), start=7.0)


class Capsule(unittest.TestCase):
    def check(self, Ca, C, nodes, timestep):
        reference = read_reference()[(Ca, C)]
        _, volume_error, _, inclination, deformation = run_capsule(Ca, C, nodes, timestep)
        error = deformation / float(reference["D12"]) - 1
        angle = inclination - 180 * float(reference["theta_over_pi"])
        print(f"  Ca {Ca} C {C} nodes {nodes}: D12 {deformation:.5f} error {100 * error:+.2f} %, "
              f"inclination {inclination:.3f} deg error {angle:+.3f} deg")
        self.assertLess(abs(error), 0.015)
        self.assertLess(abs(angle), 0.6)
        self.assertLess(volume_error, 1e-6)

    def test_ca_015(self):
        self.check(0.15, 1.0, 642, 0.01)

    def test_ca_03(self):
        self.check(0.3, 1.0, 642, 0.02)

    def test_larger_box_changes_little(self):
        small, large = (run_capsule(0.3, 1.0, 162, 0.04, box=box)[4] for box in (12.0, 18.0))
        print(f"  D12 in a box of 12: {small:.5f}, of 18: {large:.5f}")
        self.assertLess(abs(small / large - 1), 0.003)


if __name__ == "__main__":
    unittest.main()
