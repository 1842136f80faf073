"""The command biem-analysis: its files, its messages, its exit status."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from matplotlib.image import imread
from synthetic import SOURCE, Files, make_discocyte, make_icosphere, rotate_y


class Command(unittest.TestCase):
    """Four red cells that turn in a sheared box, analysed from the shell."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = holder.name
        sphere, triangles = make_icosphere(2)
        cell = make_discocyte(sphere)
        places = np.array([[2, 2, 2], [7, 6, 4], [3, 9, 7], [9, 3, 9]])
        frames = [np.concatenate([rotate_y(cell, 10.0 * k + 30.0 * c) + place
                                  for c, place in enumerate(places)]) for k in range(4)]
        files = Files(cls.folder, triangles, len(sphere), 4)
        cls.data = files.write_data(frames[0])
        cls.dump = files.write_dump(frames, tilts=[0.0, 3.0, 6.0, -3.0])

    def run_command(self, *arguments):
        """Exit status, standard output and standard error of the command."""
        environment = dict(os.environ, PYTHONPATH=SOURCE)
        done = subprocess.run([sys.executable, "-m", "biem_analysis", *arguments],
                              capture_output=True, text=True, env=environment, check=False)
        return done.returncode, done.stdout, done.stderr

    def test_version(self):
        status, output, _ = self.run_command("--version")
        self.assertEqual(status, 0)
        self.assertRegex(output, r"^biem-analysis \d+\.\d+")

    def test_shapes_table(self):
        out = os.path.join(self.folder, "shapes.csv")
        status, output, error = self.run_command(
            "shapes", "--data", self.data, "--dump", self.dump, "--timestep", "0.02", "--out", out)
        self.assertEqual(status, 0, error)
        self.assertIn("4 frames of 4 cells", output)
        self.assertIn("4/4", error)    # progress
        with open(out, encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(len(rows), 16)
        self.assertEqual((rows[5]["step"], rows[5]["time"], rows[5]["cell"]), ("100", "2", "2"))
        for row in rows:
            self.assertAlmostEqual(float(row["volume"]) / (4 * np.pi / 3), 1.0, delta=0.05)
            self.assertLess(float(row["area_strain_max"]), 1e-8)
        # turned by 10 degrees from z toward x: the disc's long direction sinks by 10 degrees
        self.assertAlmostEqual(float(rows[0]["inclination_in_plane"]), 0.0, delta=1e-6)
        self.assertAlmostEqual(float(rows[4]["inclination_in_plane"]), -10.0, delta=1e-6)

    def test_pictures(self):
        out = os.path.join(self.folder, "pictures")
        status, output, error = self.run_command(
            "pictures", "--data", self.data, "--dump", self.dump, "--timestep", "0.02",
            "--out", out, "--width", "500", "--quiet")
        self.assertEqual((status, error), (0, ""))
        for name, least in (("shapes.png", 800), ("snapshots.png", 600), ("final.png", 500)):
            self.assertIn(os.path.join(out, name), output)
            image = imread(os.path.join(out, name))[..., :3]
            self.assertGreaterEqual(image.shape[1], least)
            painted = np.abs(image - 1.0).max(axis=2) > 0.1
            self.assertGreater(painted.mean(), 0.02)
            self.assertLess(painted.mean(), 0.8)
        red = (image[..., 0] > image[..., 1] + 0.15) & (image[..., 0] > image[..., 2] + 0.1)
        self.assertGreater(red.mean(), 0.02)

    def assert_refused(self, *arguments, words=(), status=1):
        """The command fails with a message, without a traceback and without a file."""
        out = os.path.join(self.folder, "never.csv")
        found, _, error = self.run_command(*arguments, "--out", out)
        self.assertEqual(found, status)
        self.assertNotIn("Traceback", error)
        for word in words:
            self.assertIn(word, error)
        self.assertFalse(os.path.exists(out))

    def test_missing_files(self):
        self.assert_refused("shapes", "--data", "none.data", "--dump", self.dump,
                            "--timestep", "1", words=["none.data", "write_data"])
        self.assert_refused("pictures", "--data", self.data, "--dump", "none.dump",
                            "--timestep", "1", words=["none.dump", "xu yu zu"])

    def test_no_frames_selected(self):
        self.assert_refused("shapes", "--data", self.data, "--dump", self.dump, "--timestep", "1",
                            "--start", "99", words=["no frame"])

    def test_bad_arguments(self):
        self.assert_refused("shapes", "--data", self.data, "--dump", self.dump,
                            "--timestep", "-1", words=["not a positive number"], status=2)
        self.assert_refused("shapes", "--data", self.data, "--dump", self.dump,
                            words=["--timestep"], status=2)
        self.assert_refused("shapes", "--data", self.data, "--dump", self.dump, "--timestep", "1",
                            "--reference", "data", words=["biem_reference"])

    def test_folder_that_cannot_be_made(self):
        status, _, error = self.run_command(
            "pictures", "--data", self.data, "--dump", self.dump, "--timestep", "1",
            "--out", os.path.join(self.data, "pictures"))
        self.assertEqual(status, 1)
        self.assertNotIn("Traceback", error)


if __name__ == "__main__":
    unittest.main()
