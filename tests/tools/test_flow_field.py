"""Flow fields on lattices of points, outlines in a plane, and paths of surfaces."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from matplotlib.image import imread
from synthetic import SOURCE, Files, make_icosphere

from biem_analysis import BiemAnalysisError
from biem_analysis.flow_field import cut_surface, make_plane_field


def make_lattice():
    """Points in the plane y = 1.5, in random order."""
    x, z = np.meshgrid(np.linspace(-2, 2, 9), np.linspace(-1, 1, 5))
    points = np.column_stack([x.ravel(), np.full(x.size, 1.5), z.ravel()])
    return np.random.default_rng(3).permutation(points)


class PlaneField(unittest.TestCase):
    def test_every_point_finds_its_place(self):
        points = make_lattice()
        field = make_plane_field(points, 2.0 * points, 0, 2)
        self.assertEqual(field.velocity.shape, (5, 9, 3))
        self.assertAlmostEqual(field.level, 1.5)
        np.testing.assert_allclose(field.velocity[..., 0], 2 * np.tile(field.across, (5, 1)))
        np.testing.assert_allclose(field.velocity[..., 2], 2 * np.tile(field.upward, (9, 1)).T)

    def test_hole_in_the_lattice(self):
        points = make_lattice()
        hole = np.linalg.norm(points - [0.5, 1.5, 0.5], axis=1) < 1e-9
        field = make_plane_field(points[~hole], points[~hole], 0, 2)
        missing = np.isnan(field.velocity[..., 0])
        self.assertEqual(missing.sum(), 1)
        self.assertTrue(missing[3, 5])

    def test_refused(self):
        points = make_lattice()
        with self.assertRaisesRegex(BiemAnalysisError, "not in one plane"):
            make_plane_field(points, points, 0, 1)
        scattered = points + np.random.default_rng(1).normal(size=points.shape) * [1, 0, 1]
        with self.assertRaisesRegex(BiemAnalysisError, "not on a lattice"):
            make_plane_field(scattered, scattered, 0, 2)
        with self.assertRaisesRegex(BiemAnalysisError, "probes"):
            make_plane_field(points[:0], points[:0], 0, 2)


class Outline(unittest.TestCase):
    def test_sphere_gives_a_circle(self):
        points, triangles = make_icosphere(4)
        segments = cut_surface(2.0 * points[triangles], 1, 0.7)
        np.testing.assert_allclose(segments[:, :, 1], 0.7, atol=1e-12)
        length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
        radius = np.sqrt(4.0 - 0.49)
        self.assertAlmostEqual(length / (2 * np.pi * radius), 1.0, delta=0.003)
        distance = np.hypot(segments[..., 0], segments[..., 2])
        self.assertLess(np.abs(distance / radius - 1).max(), 0.005)

    def test_nothing_beside_the_surface(self):
        points, triangles = make_icosphere(1)
        self.assertEqual(len(cut_surface(points[triangles], 0, 1.5)), 0)


class Command(unittest.TestCase):
    """Two spheres that pass each other; points around a sphere."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name
        self.sphere, self.triangles = make_icosphere(2)

    def run_command(self, *arguments):
        """Exit status, standard output and standard error of the command."""
        done = subprocess.run([sys.executable, "-m", "biem_analysis", *arguments],
                              capture_output=True, text=True, check=False, cwd=self.folder,
                              env=dict(os.environ, PYTHONPATH=SOURCE))
        return done.returncode, done.stdout, done.stderr

    def check_picture(self, name):
        image = imread(os.path.join(self.folder, name))[..., :3]
        painted = np.abs(image - 1.0).max(axis=2) > 0.1
        self.assertGreater(painted.mean(), 0.005)
        self.assertLess(painted.mean(), 0.9)

    def test_trajectories(self):
        files = Files(self.folder, self.triangles, len(self.sphere), 2)
        offsets = [np.array([x, 0.0, 1.0 + 0.1 * x]) for x in (-2.0, 0.0, 2.0)]
        frames = [np.concatenate([self.sphere, 0.3 * self.sphere + o]) + [1, 2, 3] for o in offsets]
        data, dump = files.write_data(frames[0]), files.write_dump(frames)
        status, output, error = self.run_command(
            "trajectories", "--data", data, data, "--dump", dump, dump, "--timestep", "0.01",
            "--out", "paths.png", "--range", "-3", "3")
        self.assertEqual(status, 0, error)
        self.assertIn("2 runs", output)
        with open(os.path.join(self.folder, "paths.csv"), encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual([row["run"] for row in rows], ["1"] * 3 + ["2"] * 3)
        self.assertEqual([float(row["time"]) for row in rows[:3]], [0.0, 1.0, 2.0])
        found = [[float(row[f"offset_{a}"]) for a in "xyz"] for row in rows[3:]]
        np.testing.assert_allclose(found, offsets, atol=1e-8)
        self.check_picture("paths.png")

    def test_trajectories_refused(self):
        files = Files(self.folder, self.triangles, len(self.sphere), 1)
        data, dump = files.write_data(self.sphere), files.write_dump([self.sphere])
        status, _, error = self.run_command(
            "trajectories", "--data", data, "--dump", dump, "--timestep", "1")
        self.assertEqual(status, 1)
        self.assertIn("no surface of molecule 2", error)
        status, _, error = self.run_command(
            "trajectories", "--data", data, data, "--dump", dump, "--timestep", "1")
        self.assertEqual(status, 1)
        self.assertIn("2 data files and 1 dumps", error)

    def test_flow_field(self):
        points = make_lattice() - [0.0, 1.5, 0.0]
        files = Files(self.folder, self.triangles, len(self.sphere), 1)
        atoms = np.concatenate([0.5 * self.sphere, points])
        data, dump = files.write_data(atoms), files.write_dump([atoms])
        # the dump has no velocity, so that less the shear (z, 0, 0) it is at most 1
        status, output, error = self.run_command(
            "flowfield", "--data", data, "--dump", dump, "--shear-rate", "1", "--out", "field.png")
        self.assertEqual(status, 0, error)
        self.assertIn("45 points, largest velocity 1", output)
        self.check_picture("field.png")
        status, _, error = self.run_command("flowfield", "--data", data, "--dump", dump,
                                            "--frame", "5")
        self.assertEqual(status, 1)
        self.assertIn("no frame 5", error)


if __name__ == "__main__":
    unittest.main()
