"""Profiles across a channel: volume fractions and velocities with known answers; walls left out."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from matplotlib.image import imread
from synthetic import SOURCE, Files, make_icosphere

from biem_analysis import BiemAnalysisError, CellMesh, CrossProfile, universe
from biem_analysis.polyhedron import compute_volume_below

BOX = (10.0, 6.0, 8.0)


def cap_volume(height):
    """Volume of the part of a unit sphere below its lower pole + height."""
    height = np.clip(height, 0.0, 2.0)
    return np.pi * height ** 2 * (3.0 - height) / 3.0


class Volume(unittest.TestCase):
    """Volume of solids below a plane."""

    def test_cube_is_exact(self):
        corners = np.array([[x, y, z] for x in (0, 2) for y in (0, 2) for z in (0, 2)], dtype=float)
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
        vertices = corners[triangles]
        levels = np.array([-1.0, 0.0, 0.3, 1.1, 2.0, 5.0])
        for axis in range(3):
            found = compute_volume_below(vertices, vertices[:, :, axis], axis, levels)
            np.testing.assert_allclose(found, 4.0 * np.clip(levels, 0.0, 2.0), atol=1e-12)

    def test_pieces_of_any_cut_add_up(self):
        points, triangles = make_icosphere(1)
        turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
        vertices = (points @ turn)[triangles]
        levels = np.sort(np.random.default_rng(5).uniform(-1.2, 1.2, 40))
        up = compute_volume_below(vertices, vertices[:, :, 2], 2, levels)
        mirrored = vertices[:, ::-1] * [1.0, 1.0, -1.0]
        down = compute_volume_below(mirrored, mirrored[:, :, 2], 2, -levels)
        np.testing.assert_allclose(up + down, abs(np.linalg.det(vertices).sum()) / 6.0, atol=1e-12)

    def test_sphere(self):
        points, triangles = make_icosphere(4)
        vertices = points[triangles]
        levels = np.linspace(-1.0, 1.0, 11)
        found = compute_volume_below(vertices, vertices[:, :, 2], 2, levels)
        np.testing.assert_allclose(found, cap_volume(levels + 1.0), atol=0.01)


class Channel(unittest.TestCase):
    """Two spheres (types 1 and 2), an open sheet (type 3), points with u = (z, 0, 0) (type 4)."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        points, triangles = make_icosphere(3)
        z = (np.arange(16) + 0.5) * 0.5
        self.parts = [points + [3, 3, 4], points + [8, 3, 7.5 + 2 * BOX[2]],
                      np.array([[0, 0, 0], [5.0, 0, 0], [0, 3.0, 0]]),
                      np.column_stack([z, z, z])]
        self.triangles = [triangles, triangles + len(points), np.arange(3)[None] + 2 * len(points)]
        self.data, self.dump = self.write()

    def write(self, tilt=None):
        """Paths of a data file and a dump of two equal frames."""
        positions = np.concatenate(self.parts)
        kinds = 1 + np.repeat(np.arange(4), [len(part) for part in self.parts])
        files = Files(self.folder, np.concatenate(self.triangles), len(positions), 1, kinds)
        return (files.write_data(positions, box=BOX),
                files.write_dump([positions] * 2, tilts=tilt, box=BOX, shear_rate=1.0))

    def test_volume_fraction_of_sphere_and_of_periodic_images(self):
        system = universe(self.data, self.dump)
        for types, center in (([1], 4.0), ([2], 7.5)):
            results = CrossProfile(system, n_bins=16, types=types).run().results
            below = sum(cap_volume(results.edges - center + 1.0 + k * BOX[2]) for k in (-1, 0, 1))
            expected = np.diff(below) / (BOX[0] * BOX[1] * 0.5)
            self.assertGreater(expected.max(), 0.04)
            for row in results.volume_fraction:
                np.testing.assert_allclose(row, expected, atol=0.002)
        both = CrossProfile(system, n_bins=4, types=[1, 2]).run().results
        mesh = CellMesh(system, [1, 2])
        volume = np.linalg.det(np.concatenate(self.parts)[mesh.triangles]).sum() / 6.0
        self.assertAlmostEqual(both.volume_fraction.mean(), volume / np.prod(BOX), delta=1e-12)

    def test_velocity(self):
        system = universe(self.data, self.dump)
        results = CrossProfile(system, n_bins=8, types=[1], points=[4]).run().results
        np.testing.assert_allclose(results.velocity[0], results.centers, atol=1e-6)
        sparse = CrossProfile(system, n_bins=32, types=[1], points=[4]).run().results
        self.assertEqual(np.isnan(sparse.velocity[0]).sum(), 16)
        none = CrossProfile(system, types=[1]).run().results
        self.assertTrue(np.all(np.isnan(none.velocity)))

    def test_types_of_cells(self):
        mesh = CellMesh(universe(self.data, self.dump), [1, 2])
        np.testing.assert_array_equal(mesh.types, [1, 2])
        np.testing.assert_array_equal(mesh.molecules, [1, 2])
        with self.assertRaisesRegex(BiemAnalysisError, "molecule 3.*not closed.*--types"):
            CellMesh(universe(self.data, self.dump))
        with self.assertRaisesRegex(BiemAnalysisError, "no atom of type 9"):
            CellMesh(universe(self.data, self.dump), [9])
        with self.assertRaisesRegex(BiemAnalysisError, "no triangles.*chosen"):
            CellMesh(universe(self.data, self.dump), [4])

    def test_bad_input(self):
        system = universe(self.data, self.dump)
        for options, message in (({"axis": "w"}, "not x, y or z"), ({"n_bins": 0}, "at least one"),
                                 ({"points": [7]}, "no atom of type 7")):
            with self.assertRaisesRegex(BiemAnalysisError, message):
                CrossProfile(system, types=[1], **options).run()
        tilted = universe(*self.write(tilt=[2.0, 2.0]))
        CrossProfile(tilted, types=[1], axis="z").run()
        with self.assertRaisesRegex(BiemAnalysisError, "tilted along x by 2"):
            CrossProfile(tilted, types=[1], axis="x").run()

    def test_command(self):
        out = os.path.join(self.folder, "out")
        done = subprocess.run(
            [sys.executable, "-m", "biem_analysis", "profile", "--data", self.data, "--dump",
             self.dump, "--timestep", "0.1", "--types", "1", "2", "--points", "4", "--bins", "8",
             "--out", out, "--quiet"], capture_output=True, text=True, check=False,
            env=dict(os.environ, PYTHONPATH=SOURCE))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open(os.path.join(out, "profile.csv"), encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(list(rows[0]), ["z", "volume_fraction", "velocity"])
        self.assertEqual(len(rows), 8)
        self.assertAlmostEqual(float(rows[2]["z"]), 2.5)
        self.assertAlmostEqual(float(rows[2]["velocity"]), 2.5, delta=1e-6)
        self.assertGreater(float(rows[3]["volume_fraction"]), float(rows[1]["volume_fraction"]))
        image = imread(os.path.join(out, "profile.png"))[..., :3]
        painted = np.abs(image - 1.0).max(axis=2) > 0.1
        self.assertGreater(painted.mean(), 0.01)


if __name__ == "__main__":
    unittest.main()
