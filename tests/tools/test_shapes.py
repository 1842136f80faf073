"""CellShapes against bodies of known volume, axes, orientation and motion."""

import tempfile
import unittest

import numpy as np
from synthetic import Files, make_icosphere, rotate_y

from biem_analysis import CellShapes, universe
from biem_analysis.polyhedron import compute_cell_moments
from biem_analysis.trajectory import get_box

AXES = np.array([1.5, 1.0, 0.6])
SPHERE_VOLUME = 4.0 * np.pi / 3.0


def measure(points, triangles):
    """Moments of one closed surface."""
    start, cell = np.zeros(1, dtype=int), np.zeros(len(triangles), dtype=int)
    return compute_cell_moments(points[triangles], start, cell, points.mean(axis=0)[None])


class Temporary(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def run_shapes(self, frames, triangles, n_cells=1, tilts=None, **options):
        """CellShapes of frames (n_frames, n_atoms, 3), through files; one time unit apart."""
        files = Files(self.folder, triangles, len(frames[0]) // n_cells, n_cells)
        self.system = universe(files.write_data(frames[0]), files.write_dump(frames, tilts),
                               dt=0.01)
        return CellShapes(self.system, **options).run().results


class Moments(unittest.TestCase):
    """Closed-form moments of polyhedra."""

    def test_cube_is_exact_far_from_origin(self):
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
        moments = measure(corners + 1000.0, triangles)
        self.assertAlmostEqual(moments.volume[0], 6.0, delta=1e-11)
        self.assertAlmostEqual(moments.area[0], 22.0, delta=1e-11)
        np.testing.assert_allclose(moments.centroid[0], [1000.5, 1001.0, 1001.5], rtol=1e-14)
        np.testing.assert_allclose(moments.covariance[0], np.diag([1, 4, 9]) / 12.0, atol=1e-11)

    def test_sphere_converges_with_second_order(self):
        errors = []
        for level in (2, 3, 4):
            points, triangles = make_icosphere(level)
            moments = measure(points, triangles)
            errors.append([1 - moments.volume[0] / SPHERE_VOLUME,
                           1 - moments.area[0] / (4 * np.pi),
                           1 - moments.surface_covariance[0, 0, 0] * 3])
        errors = np.array(errors)
        self.assertTrue(np.all(errors > 0))
        self.assertLess(errors[1, 0], 0.009)    # 642 nodes
        np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.1)


class Ellipsoid(Temporary):
    """An affine image of the icosphere has exactly the moments of a scaled ellipsoid."""

    def test_volume_axes_inclination(self):
        sphere, triangles = make_icosphere(3)
        inner = measure(sphere, triangles)
        shrink = np.sqrt(5.0 * inner.covariance[0, 0, 0])    # equivalent radius of the mesh
        for angle in (-70.0, 0.0, 25.0, 89.0):
            frame = rotate_y(sphere * AXES, -angle) + [3.0, 4.0, 5.0]
            results = self.run_shapes([frame], triangles)
            self.assertAlmostEqual(results.volume[0, 0], 0.9 * inner.volume[0], delta=1e-9)
            np.testing.assert_allclose(results.centroid[0, 0], [3, 4, 5], atol=1e-9)
            np.testing.assert_allclose(results.semi_axes[0, 0], shrink * AXES, atol=1e-9)
            self.assertAlmostEqual(results.inclination_in_plane[0, 0], angle, delta=1e-7)
            self.assertAlmostEqual(results.ellipsoid_angle[0, 0], angle, delta=1e-7)
            self.assertAlmostEqual(results.inclination_3d[0, 0], abs(angle), delta=1e-5)
            self.assertAlmostEqual(results.taylor_deformation[0, 0], 0.9 / 2.1, delta=1e-9)

    def test_cell_axis_along_vorticity_keeps_in_plane_values(self):
        sphere, triangles = make_icosphere(2)
        frame = rotate_y(sphere * [1.2, 2.0, 0.6], -30.0)
        results = self.run_shapes([frame], triangles)
        self.assertAlmostEqual(results.inclination_3d[0, 0], 90.0, delta=1e-5)
        np.testing.assert_allclose(results.cell_axis[0, 0], [0, 1, 0], atol=1e-7)
        self.assertAlmostEqual(results.inclination_in_plane[0, 0], 30.0, delta=1e-7)
        self.assertAlmostEqual(results.taylor_deformation[0, 0], 0.6 / 1.8, delta=1e-9)

    def test_deformation_is_that_of_the_cut_and_not_of_the_projection(self):
        sphere, triangles = make_icosphere(2)
        axes, turn = np.array([2.0, 1.0, 0.5]), np.radians(35.0)
        about_z = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0],
                            [0, 0, 1]])
        results = self.run_shapes([sphere * axes @ about_z], triangles)
        along_x = 1.0 / np.sqrt((np.cos(turn) / axes[0]) ** 2 + (np.sin(turn) / axes[1]) ** 2)
        expected = (along_x - 0.5) / (along_x + 0.5)
        self.assertAlmostEqual(results.taylor_deformation[0, 0], expected, delta=1e-9)
        self.assertAlmostEqual(results.inclination_3d[0, 0], 35.0, delta=1e-5)

    def test_other_shear_plane(self):
        sphere, triangles = make_icosphere(2)
        frame = rotate_y(sphere * AXES, -20.0)[:, [0, 2, 1]]    # z becomes y, so the plane is xy
        results = self.run_shapes([frame], triangles[:, ::-1], shear_plane="xy")
        self.assertAlmostEqual(results.inclination_in_plane[0, 0], 20.0, delta=1e-7)

    def test_node_order_of_triangles_does_not_matter(self):
        sphere, triangles = make_icosphere(2)
        mixed = triangles.copy()
        mixed[::3] = mixed[::3, ::-1]
        volumes = [self.run_shapes([sphere], mesh).volume[0, 0]
                   for mesh in (triangles, mixed, triangles[:, ::-1])]
        np.testing.assert_allclose(volumes, volumes[0], rtol=1e-12)
        self.assertGreater(volumes[0], 0.9 * SPHERE_VOLUME)

    def test_area_strain_of_uniform_growth(self):
        sphere, triangles = make_icosphere(2)
        results = self.run_shapes([sphere, 1.1 * sphere], triangles)
        np.testing.assert_allclose(results.area_strain_mean[:, 0], [0.0, 0.21], atol=1e-9)
        np.testing.assert_allclose(results.area_strain_max[:, 0], [0.0, 0.21], atol=1e-9)
        results = self.run_shapes([sphere], triangles, reference=2.0 * sphere)
        self.assertAlmostEqual(results.area_strain_mean[0, 0], 0.75, delta=1e-9)


class Motion(Temporary):
    """Cells that move, turn and cross the boundaries of a sheared periodic box."""

    def test_tank_treading_phase(self):
        sphere, triangles = make_icosphere(3)
        rate, times = 0.26, np.arange(0.0, 60.0, 1.0)
        frames = [rotate_y(rotate_y(sphere, np.degrees(rate * time)) * AXES,
                           -15.0 - 5.0 * np.sin(time)) for time in times]
        results = self.run_shapes(frames, triangles)
        np.testing.assert_allclose(results.phase[:, 0], rate * times, atol=1e-6)
        self.assertAlmostEqual(results.angular_frequency[0], rate, delta=1e-8)

    def test_rigid_tumbling_is_not_tank_treading(self):
        sphere, triangles = make_icosphere(2)
        frames = [rotate_y(sphere * AXES, 25.0 * step) for step in range(20)]
        results = self.run_shapes(frames, triangles)
        np.testing.assert_allclose(results.phase, 0.0, atol=1e-6)

    def test_box_flip(self):
        """Image flags follow LAMMPS' flip rule ix -= iz; the unwrapped cell notices nothing."""
        sphere, triangles = make_icosphere(2)
        length, rate, step = 12.0, 1.0, 0.05
        place = np.concatenate([sphere + [1.0, 5.0, 11.7], sphere + [6.0, 5.0, 3.0]])
        height = np.repeat([11.7, 3.0], len(sphere))
        tilt, images = 0.0, np.zeros((len(place), 3))
        frames, tilts, n_flips = [], [], 0
        for k in range(40):
            box = np.array([[length, 0, 0], [0, length, 0], [tilt, 0, length]])
            wrapped = place - images @ box
            new_images = np.floor(wrapped @ np.linalg.inv(box))
            wrapped, images = wrapped - new_images @ box, images + new_images
            frames.append(wrapped + images @ box)
            tilts.append(tilt)
            place = frames[-1] + np.column_stack([rate * height * step * 8, 0 * height, 0 * height])
            tilt += rate * length * step * 8
            if tilt > 0.5 * length:
                tilt -= length
                images[:, 0] += images[:, 2]    # n = -1 in domain->image_flip
                n_flips += 1
        self.assertGreaterEqual(n_flips, 10)
        results = self.run_shapes(frames, triangles, n_cells=2, tilts=tilts)
        np.testing.assert_allclose(results.volume, results.volume[0, 0], rtol=1e-9)
        np.testing.assert_allclose(results.taylor_deformation, 0.0, atol=1e-8)
        speed = np.diff(results.centroid[:, :, 0], axis=0) / 0.4
        np.testing.assert_allclose(speed, [[11.7, 3.0]] * 39, atol=1e-7)
        for timestep, expected in zip(self.system.trajectory, tilts):
            box, origin = get_box(timestep)
            np.testing.assert_allclose(box, [[12, 0, 0], [0, 12, 0], [expected, 0, 12]],
                                       atol=1e-12)
            np.testing.assert_allclose(origin, 0.0, atol=1e-12)

    def test_precision_is_kept_far_from_the_origin(self):
        sphere, triangles = make_icosphere(2)
        results = self.run_shapes([sphere, sphere + [123456.0, 0.0, 0.0]], triangles)
        self.assertAlmostEqual(results.volume[1, 0] / results.volume[0, 0], 1.0, delta=1e-5)

    def test_times_follow_the_steps(self):
        sphere, triangles = make_icosphere(1)
        results = self.run_shapes([sphere] * 3, triangles)
        np.testing.assert_allclose(results.times, [0.0, 1.0, 2.0])
        np.testing.assert_array_equal(results.steps, [0, 100, 200])


if __name__ == "__main__":
    unittest.main()
