"""The viscosity-ratio tests on all meshes: tables of errors against the number of nodes."""

import sys
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "physics"))

import ratio_cases as exact    # noqa: E402
import test_viscosity_ratio as coarse    # noqa: E402

RATIOS = (0.2, 1.0, 5.0, 20.0)
MESHES = (162, 642, 2562)


class FineRigidLimit(coarse.RigidLimit):
    nodes = 642


class Convergence(unittest.TestCase):
    def check(self, traction, finest):
        for ratio in RATIOS:
            errors = np.abs([coarse.measure_errors(nodes, ratio, traction) for nodes in MESHES])
            self.assertLess(errors[-1].max(), finest)
            # the largest error of the four falls by more than a factor of 2.5 per refinement
            largest = errors.max(axis=(1, 2))
            self.assertGreater((largest[:-1] / largest[1:]).min(), 2.5)

    def test_consistent(self):
        self.check("consistent", 0.005)

    def test_lumped(self):
        self.check("lumped", 0.015)

    def test_drop_stresslet(self):
        for ratio in (0.2, 5.0, 20.0):
            expected, errors = exact.compute_drop_stresslet(ratio), []
            for nodes in MESHES:
                stresslet = exact.measure_undeformed(
                    "sphere radius 1", nodes, f"cells all viscosity/ratio {ratio}", box=36.0)[1]
                errors.append(abs(stresslet / expected - 1.0))
                print(f"  lambda {ratio:g} nodes {nodes}: stresslet {stresslet:.5f}, exact "
                      f"{expected:.5f}, error {100 * errors[-1]:.3f} %")
            self.assertGreater(min(errors[0] / errors[1], errors[1] / errors[2]), 3.5)


if __name__ == "__main__":
    unittest.main()
