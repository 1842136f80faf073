"""Rigid particles and walls against exact results: all tabulated cases at 162, 642 and 2562 nodes.
Prints the tables of doc/validation.md."""

import sys
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "physics"))

import rigid_cases as cases    # noqa: E402

MESHES = (162, 642, 2562)


def print_row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def percent(error):
    return f"{100.0 * error:+.2f} %"


def print_errors(name, values, exact):
    """A row: case, exact value, values and errors on the meshes, order of the last refinement."""
    errors = np.array(values) / exact - 1.0
    print_row(name, f"{exact:.6g}", *[f"{v:.6g}" for v in values], *map(percent, errors),
              f"{cases.compute_order(errors)[-1]:.2f}")
    return errors


class PeriodicArrays(unittest.TestCase):
    def check(self, name, values, exact, bound=0.01):
        errors = print_errors(name, values, exact)
        self.assertLess(abs(errors[1]), bound, name)
        self.assertGreater(cases.compute_order(errors)[-1], 1.8, name)

    def test_drag(self):
        for row in cases.read_table("periodic_array_drag"):
            fraction = row["volume_fraction"]
            drag = cases.run_all(lambda n: cases.compute_array_drag(fraction, n), MESHES)
            # At 0.4 the gap, 0.19 a, is as wide as an edge at 642 nodes.
            self.check(f"K, {fraction:g}", drag, row["K"], 0.01 if fraction < 0.4 else 0.03)

    def test_viscosity_in_shear(self):
        for row in cases.read_table("periodic_array_viscosity"):
            fraction = row["volume_fraction"]
            beta = cases.run_all(lambda n: cases.compute_array_beta(fraction, n), MESHES)
            self.check(f"beta, {fraction:g}", beta, row["beta"])

    def test_single_sphere(self):
        self.check("stresslet/(20/3 pi mu a^3 E)",
                   cases.run_all(cases.compute_stresslet_ratio, MESHES), 1.0)
        self.check("8 pi mu a^3 W/T", cases.run_all(cases.compute_torque_ratio, MESHES), 1.0)


class Jeffery(unittest.TestCase):
    def test_orbit_of_an_oblate_spheroid(self):
        for nodes, timestep in ((162, 0.08), (162, 0.02), (642, 0.08), (642, 0.04), (2562, 0.08)):
            orbit = cases.run_jeffery(nodes, timestep)
            print_row(nodes, timestep, percent(orbit["period"] - 1.0), f"{orbit['strain']:.0e}",
                      f"{orbit['out_of_plane']:.0e}", f"{orbit['drift']:.0e}")
            self.assertLess(abs(orbit["period"] - 1.0), 0.015 if nodes == 162 else 0.005)
            self.assertLess(orbit["strain"], 1e-12)
            self.assertLess(max(orbit["out_of_plane"], orbit["drift"]), 1e-5)

    def test_slow_rotation(self):
        for nodes in MESHES + (10242,):
            rolls = (0, 30, 90) if nodes < 10000 else (0,)
            errors = [cases.compute_slow_rotation(nodes, roll) - 1.0 for roll in rolls]
            print_row(nodes, *map(percent, errors))
            self.assertLess(np.abs(errors).max(), 0.15 if nodes == 162 else 0.008)


class TwoSpheres(unittest.TestCase):
    names = ("x11a", "x12a", "y11a", "y12a")
    # Largest error of the four at 642 and 2562 nodes, by gap.
    bounds = {8.0: (0.004, 0.002), 4.0: (0.004, 0.002), 2.0: (0.004, 0.002), 0.5: (0.004, 0.002),
              0.1: (0.015, 0.006), 0.02: (0.04, 0.02)}

    def test_mobilities(self):
        for row in cases.read_table("two_sphere"):
            gap = row["gap_over_a"]
            exact = np.array([row[name] for name in self.names])
            errors = []
            # At 162 nodes and gap 0.02 the meshes would overlap.
            meshes = MESHES if gap > 0.05 else MESHES[1:]
            measured = cases.run_all(lambda n: cases.compute_pair_mobilities(gap, n), meshes)
            for nodes, found in zip(meshes, measured):
                errors.append(np.abs(found / exact - 1.0).max())
                print_row(gap, nodes, *[f"{v:.5f} | {percent(v / e - 1.0)}"
                                        for v, e in zip(found, exact)])
            for error, bound in zip(errors[-2:], self.bounds[gap]):
                self.assertLess(error, bound, gap)


class OneWall(unittest.TestCase):
    names = ("drag_perpendicular", "Ft", "Tr", "Fs", "Ts", "U_free_over_hS",
             "Omega_free_over_half_S")

    def run_case(self, row, nodes, edge):
        h = row["h_over_a"]
        found = cases.compute_wall_coefficients(h, nodes, edge, max(16.0, 10.0 * h))
        errors = {name: found[name] / row[name] - 1.0 for name in self.names}
        errors["Tt"] = found["Tt"] - row["Tt"]
        print_row(f"{h:.4g}", nodes, f"{edge:.2g}", *[percent(errors[n]) for n in self.names],
                  f"{errors['Tt']:+.4f}")
        return errors

    def test_coefficients(self):
        for row in sorted(cases.read_table("sphere_near_wall"), key=lambda r: -r["h_over_a"]):
            h = row["h_over_a"]
            self.run_case(row, 162, 0.4 * h if h > 1.5 else 0.3)
            errors = self.run_case(row, 642, 0.2 * h if h > 1.5 else 0.2)
            if h < 1.5:
                finest = self.run_case(row, 2562, 0.2)["drag_perpendicular"]
                self.assertLess(abs(finest), abs(errors["drag_perpendicular"]))
            for name in self.names:
                self.assertLess(abs(errors[name]), self.find_bound(h, name), (h, name))
            self.assertLess(abs(errors["Tt"]), 0.003 if h > 1.1 else 0.06)

    # Gaps below an edge length, 0.15 at 642 nodes, are not resolved.
    @staticmethod
    def find_bound(h, name):
        if h > 1.5:
            return 0.01
        if name == "drag_perpendicular":
            return 0.03 if h > 1.1 else 0.45
        return 0.01 if h > 1.1 else 0.1


class Channel(unittest.TestCase):
    # Faxen's series is a truncated one: it is compared where its own error is below 0.3 %.
    def test_mobility_along_the_walls(self):
        for place, ratio, bound in ((0.5, 0.1, 0.004), (0.5, 0.2, 0.004), (0.5, 0.3, 0.007),
                                    (0.25, 0.2, 0.004), (0.25, 0.3, 0.004), (0.25, 0.5, 0.004)):
            width = 1.0 / (place * ratio)
            values = cases.run_all(
                lambda n: cases.compute_channel_mobility(place, width, n, width / 10), MESHES)
            errors = print_errors(f"{place}, {ratio}", values,
                                  cases.compute_faxen_mobility(place, width))
            self.assertLess(abs(errors[1]), bound)


class Reciprocity(unittest.TestCase):
    def test_mobility_is_symmetric(self):
        asymmetry = []
        for nodes in MESHES[:2]:
            found = cases.measure_reciprocity(nodes, 0.4)
            print_row(nodes, percent(found["cross"]), percent(found["all"]))
            asymmetry.append(found["cross"])
        self.assertLess(asymmetry[0], 0.03)
        self.assertGreater(cases.compute_order(asymmetry)[0], 1.7)

    def test_forces_of_other_fixes_count_as_prescribed_ones(self):
        for nodes in MESHES[:2]:
            pushed, given = cases.compare_pushes(nodes)
            print_row(nodes, f"{np.abs(pushed - given).max():.0e}")
            np.testing.assert_allclose(pushed, given, rtol=0.0, atol=1e-12)


if __name__ == "__main__":
    unittest.main()
