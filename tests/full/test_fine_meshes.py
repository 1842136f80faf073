"""The physics tests on finer meshes: a red cell at 642 nodes, capsule convergence to 2562 nodes."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "physics"))

import test_red_cell    # noqa: E402
from test_capsule import read_reference, run_capsule    # noqa: E402


class FineRedCell(test_red_cell.RedCell):
    nodes, timestep = 642, 0.002


class CapsuleConvergence(unittest.TestCase):
    def test_error_falls_with_refinement(self):
        reference = float(read_reference()[(0.3, 1.0)]["D12"])
        errors = []
        for nodes, timestep in ((162, 0.04), (642, 0.02), (2562, 0.01)):
            deformation = run_capsule(0.3, 1.0, nodes, timestep)[4]
            errors.append(abs(deformation / reference - 1))
            print(f"  nodes {nodes}: D12 {deformation:.5f} error {100 * errors[-1]:.3f} %")
        self.assertLess(errors[1], errors[0])
        self.assertLess(errors[2], 0.002)


if __name__ == "__main__":
    unittest.main()
