"""Flow between walls through LAMMPS: exact flows of empty vessels, both drives, balance of forces,
walls that move, walls from files, and a channel with a red cell and a platelet."""

import unittest

import numpy as np

import wall_cases as cases
from wall_cases import VISCOSITY, Scene

LATTICE = "create_wall plane z 0 edge 0.5 group wall"


class EmptyVessels(unittest.TestCase):
    def check(self, name, errors, bounds):
        print(f"  {name}: {cases.format_errors(errors)}")
        for quantity, bound in bounds.items():
            self.assertLess(abs(errors[quantity]), bound, f"{name}: {quantity}")
        self.assertLess(abs(errors["balance"]), 1e-9, name)
        self.assertEqual(errors["iterations"], 0, "lattice walls alone are solved directly")

    def test_channel(self):
        bounds = {"resistance": 3e-4, "maximum": 3e-4, "profile": 3e-4, "shear": 3e-4}
        for flow in ("mean 0.8 0 0", "pressure/drop 2 0 0"):
            self.check(f"channel, {flow}", cases.measure_channel(cases.make_channel(0.5), flow),
                       bounds)

    def test_channel_flow_along_both_directions(self):
        scene = Scene(cases.CHANNEL, LATTICE)
        one = scene.run("mean 0.8 0.3 0", [(1.0, 1.0, 1.3)])
        self.assertAlmostEqual(one["velocity"][0, 1] / one["velocity"][0, 0], 0.3 / 0.8, places=4)

    def test_duct(self):
        coarse, fine = (cases.measure_duct(edge) for edge in (0.8, 0.4))
        self.check("duct, edge 0.8", coarse, {"resistance": 1e-2, "profile": 5e-2})
        self.check("duct, edge 0.4", fine, {"resistance": 1e-3, "maximum": 5e-4, "shear": 1e-3,
                                            "profile": 1e-2, "corner": 1e-2})
        self.assertLess(abs(fine["resistance"]), abs(coarse["resistance"]) / 4.0, "second order")

    def test_tube(self):
        coarse, fine = (cases.measure_tube(cases.make_tube(edge)) for edge in (0.6, 0.3))
        self.check("tube, edge 0.6", coarse, {"mean": 4e-2, "maximum": 5e-2})
        self.check("tube, edge 0.3", fine, {"mean": 1e-2, "maximum": 1.2e-2, "profile": 2e-2})
        self.assertLess(abs(fine["mean"]), abs(coarse["mean"]) / 3.5, "second order")
        self.assertLess(abs(fine["maximum"]), abs(coarse["maximum"]) / 3.5, "second order")

    def test_irregular_mesh_from_file(self):
        """No lattice: the wall block is inverted as a dense matrix."""
        scene = Scene(cases.CHANNEL, "create_wall mesh sheet.off group wall",
                      files={"sheet.off": cases.make_sheet_off(cases.CHANNEL[:2], (8, 6), seed=1)})
        self.check("irregular sheet", cases.measure_channel(scene, "mean 0.8 0 0"),
                   {"resistance": 3e-4, "maximum": 3e-4, "profile": 1e-3, "shear": 3e-4})


class MovingWalls(unittest.TestCase):
    height = 4.0
    z = height * np.array([0.02, 0.2, 0.4, 0.6, 0.8, 0.95])

    def run_couette(self, flow):
        scene = Scene((2.4, 2.4, self.height),
                      f"create_wall plane z 0 edge 0.6 group low\ncreate_wall plane z "
                      f"{0.5 * self.height!r} edge 0.6 group high\ngroup wall union low high",
                      "wall low wall high velocity 1 0 0")
        return scene, scene.run(flow, [(0.31, 0.47, z) for z in self.z])

    def test_couette(self):
        """Between the walls at z = 0 and H/2, and between H/2 and H."""
        exact = 1.0 - np.abs(1.0 - 2.0 * self.z / self.height)
        for flow in ("pressure/drop 0 0 0", "mean 0.5 0 0"):
            scene, result = self.run_couette(flow)
            np.testing.assert_allclose(result["velocity"][:, 0], exact, atol=1e-4, err_msg=flow)
            np.testing.assert_allclose(result["velocity"][:, 1:], 0.0, atol=1e-4, err_msg=flow)
            self.assertAlmostEqual(result["mean"], 0.5, delta=1e-4)
            self.assertAlmostEqual(result["drop"], 0.0, delta=1e-4)
            area = scene.box[0] * scene.box[1]
            shear = 2.0 / self.height
            self.assertAlmostEqual(result["first"] / (-2.0 * area * VISCOSITY * shear), 1.0,
                                   delta=1e-3, msg="force of the resting wall on the fluid")

    def test_couette_and_poiseuille(self):
        _, result = self.run_couette("mean 0.7 0 0")
        gap = 0.5 * self.height
        inside = np.where(self.z < gap, self.z, self.z - gap)
        exact = (1.0 - np.abs(1.0 - self.z / gap)
                 + 0.2 * 12.0 / gap ** 2 * cases.channel_velocity(gap, inside))
        np.testing.assert_allclose(result["velocity"][:, 0], exact, atol=1e-3)
        self.assertAlmostEqual(result["drop"] * gap ** 2 / (12.0 * VISCOSITY * 0.2), 1.0,
                               delta=1e-3)

    def test_one_wall_takes_the_fluid_along(self):
        scene = Scene(cases.CHANNEL, LATTICE, "wall wall velocity 0.3 0.1 0")
        result = scene.run("pressure/drop 0 0 0", [(1.0, 1.0, 0.1), (1.0, 1.0, 2.0)])
        np.testing.assert_allclose(result["velocity"], [[0.3, 0.1, 0.0]] * 2, atol=1e-6)
        self.assertAlmostEqual(result["mean"], 0.3, delta=1e-6)

    def test_moving_tube(self):
        moving = cases.measure_tube(cases.make_tube(0.6, "wall wall velocity 0.4 0 0"), 0.4)
        resting = cases.measure_tube(cases.make_tube(0.6))
        for name in ("mean", "maximum", "profile"):
            self.assertAlmostEqual(moving[name], resting[name], delta=1e-6)


class Cells(unittest.TestCase):
    """A red cell and a platelet between the walls."""

    accuracy = 1e-4

    @classmethod
    def setUpClass(cls):
        around, cls.weights = cases.make_sphere_rule(0.65)
        x, y = ((np.arange(8) + 0.5) / 8 * side for side in cases.CROWDED.box[:2])
        plane = [(a, b, 0.2) for a in x for b in y]
        cls.normals, cls.n_plane = around / 0.65, len(plane)
        cls.points = plane + [tuple(p) for p in cases.PLATELET + around]
        cls.given_mean = cases.CROWDED.run("mean 1 0 0", cls.points, cls.accuracy, steps=3)

    def test_wall_force_balances_the_pressure_drop(self):
        result = self.given_mean
        volume, area = cases.CROWDED.volume, np.prod(cases.CROWDED.box[:2])
        self.assertAlmostEqual(result["force"][0] / (result["drop"] * volume), 1.0,
                               delta=10.0 * self.accuracy)
        self.assertAlmostEqual(result["stress"] * 2.0 * area / (result["drop"] * volume), 1.0,
                               delta=10.0 * self.accuracy)
        empty = 12.0 * VISCOSITY / cases.CROWDED.box[2] ** 2
        self.assertGreater(result["drop"], 1.01 * empty, "cells and particles resist")

    def test_both_drives_agree(self):
        given = self.given_mean
        reverse = cases.CROWDED.run(f"pressure/drop {given['drop']!r} 0 0", self.points,
                                    self.accuracy, steps=3)
        print(f"  mean 1 -> drop {given['drop']:.8f} -> mean {reverse['mean']:.8f}, "
              f"{given['iterations']:.0f} and {reverse['iterations']:.0f} iterations")
        self.assertAlmostEqual(reverse["mean"], 1.0, delta=10.0 * self.accuracy)
        np.testing.assert_allclose(reverse["velocity"], given["velocity"],
                                   atol=10.0 * self.accuracy)
        self.assertAlmostEqual(reverse["force"][0] / (reverse["drop"] * cases.CROWDED.volume), 1.0,
                               delta=10.0 * self.accuracy)

    def test_no_flux_through_closed_surfaces(self):
        velocity = self.given_mean["velocity"]
        through = np.einsum("pi,pi->p", velocity[self.n_plane:], self.normals)
        flux, size = self.weights @ through, self.weights @ np.abs(through)
        print(f"  flux around the platelet {flux / size:.2g}, along the wall "
              f"{velocity[:self.n_plane, 2].mean():.2g}")
        self.assertLess(abs(flux), 1e-3 * size)
        self.assertGreater(np.abs(velocity[:self.n_plane, 2]).max(), 1e-3)
        self.assertLess(abs(velocity[:self.n_plane, 2].mean()), 1e-4)

    def test_few_iterations(self):
        self.assertLessEqual(self.given_mean["iterations"], 5)


if __name__ == "__main__":
    unittest.main()
