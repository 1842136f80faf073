"""Membranes and drops with another viscosity inside, against exact results for the sphere
(ratio_cases.py): linear response, stresslet, and the limit of a rigid particle."""

import unittest

import numpy as np

import ratio_cases as exact

NAMES = ("D/Ca", "angle slope", "slow rate", "fast rate")
RIGID_STRESSLET = 20.0 * np.pi / 3.0 * 0.5    # of the unit sphere in the shear of rate 1


def measure_errors(nodes, ratio, traction, moduli=(1.0, 50.0)):
    """Relative errors of the four observables for each C = ED/(2 ES)."""
    measured = exact.measure_matrices(nodes, ratio, traction)
    errors = []
    for C in moduli:
        value, expected = (exact.compute_observables(m, C)
                           for m in (measured, exact.compute_exact_matrices(ratio)))
        errors.append(value / expected - 1.0)
        text = ", ".join(f"{name} {v:.5g} ({100 * e:+.2f} %)"
                         for name, v, e in zip(NAMES, value, errors[-1]))
        print(f"  lambda {ratio:g} C {C:g} nodes {nodes} {traction}: {text}")
    return np.array(errors)


class Theory(unittest.TestCase):
    def test_agrees_with_the_reference_table(self):
        table = exact.read_reference()
        self.assertEqual(len(table), 8)
        for (C, ratio), expected in table.items():
            value = exact.compute_observables(exact.compute_exact_matrices(ratio), C)
            np.testing.assert_allclose(value, expected, rtol=3e-7)

    def test_steady_deformation_does_not_depend_on_the_ratio(self):
        steady = [exact.compute_observables(exact.compute_exact_matrices(ratio), 1.0)[0]
                  for ratio in (0.2, 1.0, 5.0, 20.0)]
        np.testing.assert_allclose(steady, 25.0 / 12.0, rtol=1e-12)


class LinearResponse(unittest.TestCase):
    nodes, bound = 642, 0.02

    def check(self, ratio):
        errors = measure_errors(self.nodes, ratio, "consistent")
        self.assertLess(np.abs(errors).max(), self.bound)
        self.assertLess(np.abs(errors[:, :3]).max(), 0.25 * self.bound)    # all but the fast rate

    def test_ratio_02(self):
        self.check(0.2)

    def test_ratio_1(self):
        self.check(1.0)

    def test_ratio_5(self):
        self.check(5.0)

    def test_ratio_20(self):
        self.check(20.0)

    def test_lumped_traction_slow_modes(self):
        for ratio in (0.2, 20.0):
            errors = measure_errors(self.nodes, ratio, "lumped", moduli=(1.0,))
            self.assertLess(np.abs(errors[:, :3]).max(), 0.02)


class SteadyShear(unittest.TestCase):
    """With time steps, at a capillary number so small that the response is linear."""

    def test_deformation_and_inclination(self):
        for ratio, Ca, timestep in ((0.2, 0.02, 0.0008), (5.0, 0.01, 0.002)):
            deformation, inclination = exact.run_steady_shear(
                162, ratio, 1.0, Ca, timestep, duration=1.0)
            linear, angle = exact.compute_steady_shear(ratio, 1.0, Ca)
            print(f"  lambda {ratio:g} Ca {Ca}: D12 {deformation:.5f} "
                  f"({100 * (deformation / linear - 1):+.2f} %), inclination {inclination:.3f} "
                  f"({inclination - angle:+.3f}) degrees")
            # 2.5 % is the error of the mesh: 0.8 % at 642 nodes
            self.assertAlmostEqual(deformation / linear, 1.0, delta=0.03)
            self.assertAlmostEqual(inclination, angle, delta=0.15)


class DropStresslet(unittest.TestCase):
    def test_second_order(self):
        for ratio in (0.2, 5.0, 20.0):
            expected, errors = exact.compute_drop_stresslet(ratio), []
            for nodes in (162, 642):
                _, stresslet, _, _ = exact.measure_undeformed(
                    "sphere radius 1", nodes, f"cells all viscosity/ratio {ratio}", box=24.0)
                errors.append(abs(stresslet / expected - 1.0))
                print(f"  lambda {ratio:g} nodes {nodes}: stresslet {stresslet:.5f}, exact "
                      f"{expected:.5f}, error {100 * errors[-1]:.3f} %")
            self.assertLess(errors[1], 0.005)
            self.assertGreater(errors[0] / errors[1], 3.5)


class RigidLimit(unittest.TestCase):
    nodes = 162

    def check(self, shape):
        """Returns the rotation and the stresslet of the rigid body."""
        rigid = exact.measure_undeformed(shape, self.nodes, "rigid all")
        self.assertLess(rigid[2], 1e-8)
        print(f"  {shape}, rigid: rotation {rigid[0]:.6f}, stresslet {rigid[1]:.5f}")
        scaled = []
        for ratio in (100.0, 1000.0, 10000.0):
            cell = exact.measure_undeformed(
                shape, self.nodes, f"cells all viscosity/ratio {ratio}", accuracy=1e-6)
            scaled.append([ratio * (cell[0] / rigid[0] - 1.0), ratio * (cell[1] / rigid[1] - 1.0),
                           ratio * cell[2]])
            print(f"  lambda {ratio:g}: lambda times error of rotation {scaled[-1][0]:+.3f}, of "
                  f"stresslet {scaled[-1][1]:+.3f}; lambda times deviation from a rigid motion "
                  f"{scaled[-1][2]:.3f}; {cell[3]:.0f} iterations")
        scaled = np.array(scaled)
        # errors are of the first order in 1/lambda: the products tend to constants
        np.testing.assert_allclose(scaled[1:, 1:], scaled[:-1, 1:], rtol=0.06)
        self.assertLess(np.abs(scaled[:, 0]).max(), 0.2)
        return rigid, scaled

    def test_sphere(self):
        rigid, scaled = self.check("sphere radius 1")
        self.assertAlmostEqual(rigid[0], 0.5, delta=1e-6)
        self.assertAlmostEqual(rigid[1] / RIGID_STRESSLET, 1.0, delta=0.025)
        # exact for the sphere: (lambda - 1) 2/(2 lambda + 3) = 1 - 5/(2 lambda) + ...
        self.assertAlmostEqual(scaled[-1, 1], -2.5, delta=0.1)

    def test_oblate_spheroid(self):
        self.check("platelet diameter 2 thickness 0.5 orientation 1 0 0.5")


if __name__ == "__main__":
    unittest.main()
