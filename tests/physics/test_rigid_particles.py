"""Rigid particles and walls against exact results at 162 and 642 nodes. The same for all tabulated
cases and finer meshes: tests/full/test_rigid_particles.py."""

import unittest

import numpy as np
import rigid_cases as cases

MESHES = (162, 642)


class PeriodicArrays(unittest.TestCase):
    def check(self, name, measured, exact, bound):
        errors = np.array(measured) / exact - 1.0
        order = cases.compute_order(errors)[-1]
        print(f"  {name}: errors {100 * errors[0]:+.2f} %, {100 * errors[1]:+.2f} % at "
              f"{MESHES[0]}, {MESHES[1]} nodes, order {order:.2f}")
        self.assertLess(abs(errors[1]), bound)
        self.assertGreater(order, 1.7)

    def test_drag(self):
        for row in cases.read_table("periodic_array_drag"):
            fraction = row["volume_fraction"]
            if fraction in (0.027, 0.125, 0.25):
                drag = cases.run_all(lambda n: cases.compute_array_drag(fraction, n), MESHES)
                self.check(f"drag at volume fraction {fraction}", drag, row["K"], 0.01)

    def test_viscosity_in_shear(self):
        row = cases.read_table("periodic_array_viscosity")[2]
        fraction = row["volume_fraction"]
        beta = cases.run_all(lambda n: cases.compute_array_beta(fraction, n), MESHES)
        self.check(f"beta at volume fraction {fraction}", beta, row["beta"], 0.01)

    def test_stresslet_of_a_sphere(self):
        self.check("stresslet", cases.run_all(cases.compute_stresslet_ratio, MESHES), 1.0, 0.01)

    def test_sphere_driven_by_a_torque(self):
        self.check("rotation by a torque", cases.run_all(cases.compute_torque_ratio, MESHES), 1.0,
                   0.01)


class Jeffery(unittest.TestCase):
    def test_period_of_an_oblate_spheroid_and_its_rigid_mesh(self):
        orbit = cases.run_jeffery(642, timestep=0.08)
        print("  Jeffery orbit, 642 nodes: " +
              ", ".join(f"{key} {value:.3g}" for key, value in orbit.items()))
        self.assertLess(abs(orbit["period"] - 1.0), 0.005)
        self.assertLess(orbit["strain"], 1e-12)
        self.assertGreater(orbit["nodes_moved"], 1e-3)    # it has not closed on the same step
        self.assertLess(orbit["out_of_plane"], 1e-6)
        self.assertLess(orbit["drift"], 1e-5)


class Pairs(unittest.TestCase):
    def test_mobilities_of_two_spheres(self):
        names = ("x11a", "x12a", "y11a", "y12a")
        for row in cases.read_table("two_sphere"):
            gap = row["gap_over_a"]
            if gap not in (2.0, 0.5):
                continue
            exact = np.array([row[name] for name in names])
            errors = cases.compute_pair_mobilities(gap, 642) / exact - 1.0
            print(f"  two spheres, gap {gap}: " +
                  ", ".join(f"{n} {100 * e:+.2f} %" for n, e in zip(names, errors)))
            self.assertLess(np.abs(errors).max(), 0.005)

    def test_mobility_is_symmetric(self):
        asymmetry = cases.measure_reciprocity(162, 0.4)
        print(f"  reciprocity of sphere and platelet between walls: {asymmetry}")
        self.assertLess(asymmetry["cross"], 0.03)
        self.assertLess(asymmetry["all"], 0.004)
        self.assertGreater(asymmetry["eigenvalues"], 0.1)

    def test_forces_of_other_fixes_count_as_prescribed_ones(self):
        pushed, given = cases.compare_pushes(162)
        self.assertGreater(np.abs(given).min(), 1e-3)
        np.testing.assert_allclose(pushed, given, rtol=0.0, atol=1e-12)


class Walls(unittest.TestCase):
    def test_sphere_near_one_wall(self):
        row = next(r for r in cases.read_table("sphere_near_wall") if r["h_over_a"] == 2.0)
        bounds = {"drag_perpendicular": 0.01, "Ft": 0.01, "Tr": 0.01, "Fs": 0.01, "Ts": 0.01,
                  "U_free_over_hS": 0.003, "Omega_free_over_half_S": 0.003}
        found = cases.compute_wall_coefficients(2.0, 642, 0.8, 20.0)
        for name, bound in bounds.items():
            error = found[name] / row[name] - 1.0
            print(f"  sphere at height 2 above a wall: {name} {100 * error:+.2f} %")
            self.assertLess(abs(error), bound, name)
        self.assertLess(abs(found["Tt"] - row["Tt"]), 0.001)

    def test_sphere_between_two_walls(self):
        for place, width in ((0.5, 10.0), (0.25, 40.0 / 3.0)):
            exact = cases.compute_faxen_mobility(place, width)
            error = cases.compute_channel_mobility(place, width, 642, 0.1 * width) / exact - 1.0
            print(f"  sphere at {place} of a channel of width {width:.4g}: {100 * error:+.2f} %")
            self.assertLess(abs(error), 0.005)


if __name__ == "__main__":
    unittest.main()
