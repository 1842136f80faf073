"""The renderer: what is where in a picture."""

import tempfile
import unittest

import numpy as np
from synthetic import Files, make_icosphere

from biem_analysis import CellMesh, universe
from biem_analysis.pictures.camera import Camera
from biem_analysis.pictures.figures import compute_mean_inclination, cut_at_right_angle
from biem_analysis.pictures.paint import make_spots
from biem_analysis.pictures.rasterizer import PixelBuffer, compute_line_cover
from biem_analysis.pictures.scene import SceneRenderer, wrap_cells
from biem_analysis.pictures.smooth import refine


def draw_sphere(buffer, camera, center, radius):
    """Add a sphere to the buffer; returns its number of triangles."""
    points, triangles = make_icosphere(3)
    pixels, depth = camera.project(radius * points + center)
    buffer.add_triangles(pixels[triangles], depth[triangles])
    return len(triangles)


class Renderer(unittest.TestCase):
    """Spheres of known size in front of a known camera."""

    def setUp(self):
        corners = np.array([[x, y, z] for x in (-4, 4) for y in (-4, 4) for z in (-4, 4)])
        self.camera = Camera(azimuth=0.0, elevation=0.0).fit(corners, 300)
        self.buffer = PixelBuffer(self.camera.width, self.camera.height)

    def test_silhouette_has_the_area_of_a_disc(self):
        draw_sphere(self.buffer, self.camera, np.zeros(3), 2.0)
        _, depth = self.camera.project(np.zeros(3))
        eye = float(depth)
        pixel = float(self.camera.compute_pixel_size(depth))
        # the cone that touches the sphere cuts the plane through its center in this radius
        radius = 2.0 / np.sqrt(1.0 - (2.0 / eye) ** 2) / pixel
        found = np.sum(self.buffer.triangle >= 0)
        self.assertAlmostEqual(found / (np.pi * radius ** 2), 1.0, delta=0.01)

    def test_no_pixel_is_missing_between_triangles(self):
        draw_sphere(self.buffer, self.camera, np.zeros(3), 2.0)
        seen = (self.buffer.triangle >= 0).reshape(self.camera.height, self.camera.width)
        for row in seen:
            filled = np.flatnonzero(row)
            if len(filled):
                self.assertEqual(len(filled), filled[-1] - filled[0] + 1)

    def test_near_sphere_hides_far_sphere_in_any_order(self):
        near, far = np.array([0.0, -3.0, 0.0]), np.array([0.0, 3.0, 0.0])
        depths = []
        for order in ((near, far), (far, near)):
            buffer = PixelBuffer(self.camera.width, self.camera.height)
            for center in order:
                draw_sphere(buffer, self.camera, center, 1.0)
            depths.append(buffer.depth)
        np.testing.assert_array_equal(*depths)
        middle = self.camera.height // 2 * self.camera.width + self.camera.width // 2
        _, expected = self.camera.project(near + [0.0, -1.0, 0.0])
        self.assertAlmostEqual(depths[0][middle], float(expected), delta=0.01)

    def test_line_is_hidden_behind_the_sphere_only(self):
        draw_sphere(self.buffer, self.camera, np.zeros(3), 1.0)
        for y in (3.0, -3.0):
            begin, end = np.array([-4.0, y, 0.0]), np.array([4.0, y, 0.0])
            _, hidden = compute_line_cover(self.camera, self.buffer, begin, end, 2.0)
            _, (middle, line) = self.camera.project(np.array([[0.0, 0.0, 0.0], [0.0, y, 0.0]]))
            # the shadow that the sphere throws from the eye on the plane of the line
            share = 2.0 / np.sqrt(1.0 - 1.0 / middle ** 2) * (line / middle) / 8.0
            self.assertAlmostEqual(hidden.mean(), share if y > 0 else 0.0, delta=0.02)

    def test_flow_to_the_right_and_gradient_upward(self):
        plane, _ = self.camera.project(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]], dtype=float))
        self.assertGreater(plane[1, 0], plane[0, 0])
        self.assertLess(plane[2, 1], plane[0, 1])    # rows count downward


class Scene(unittest.TestCase):
    """Cells in the periodic box."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        sphere, triangles = make_icosphere(2)
        self.positions = np.concatenate([sphere + [6.0, 6.0, 6.0], sphere + [38.0, -7.0, 25.0]])
        files = Files(folder.name, triangles, len(sphere), 2)
        self.system = universe(files.write_data(self.positions),
                               files.write_dump([self.positions], tilts=[3.0]))
        self.mesh = CellMesh(self.system)

    def test_cells_are_wrapped_whole(self):
        box = np.array([[12.0, 0, 0], [0, 12.0, 0], [3.0, 0, 12.0]])
        wrapped = wrap_cells(self.positions, self.mesh, box, np.zeros(3))
        middle = self.mesh.mean_over_nodes(wrapped)
        np.testing.assert_allclose(middle, [[6, 6, 6], [8, 5, 1]], atol=1e-9)
        fraction = middle @ np.linalg.inv(box)
        self.assertTrue(np.all((fraction >= 0) & (fraction < 1)))
        shift = (wrapped - self.positions)[len(self.positions) // 2:]
        np.testing.assert_allclose(shift, np.broadcast_to(shift[0], shift.shape), atol=1e-9)
        steps = shift[0] @ np.linalg.inv(box)
        np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)

    def test_image(self):
        image = SceneRenderer(self.system, self.mesh, [0]).render(0, 240)
        self.assertEqual((image.dtype, image.shape[1], image.shape[2]), (np.uint8, 240, 3))
        red = image[..., 0].astype(int) - image[..., 1] > 50
        self.assertGreater(red.mean(), 0.01)
        self.assertLess(red.mean(), 0.3)
        self.assertGreater(len(np.unique(image.reshape(-1, 3), axis=0)), 200)    # shaded


    def test_spot_is_on_the_near_side_and_moves_with_the_membrane(self):
        toward = np.array([0.0, -1.0, 0.0])
        half = len(self.positions) // 2
        markers = np.array([np.argmax(self.positions[:half, 0]),
                            half + np.argmax(self.positions[half:, 2])])
        spots = make_spots(self.positions, self.mesh, markers, toward)
        offset = self.positions[spots.nodes] - self.mesh.mean_over_nodes(self.positions)
        self.assertTrue(np.all(offset @ toward > 0.4))
        self.assertGreater(offset[0, 0], 0.4)
        self.assertGreater(offset[1, 2], 0.4)
        plain = SceneRenderer(self.system, self.mesh, [0]).render(0, 240).astype(int)
        painted = SceneRenderer(self.system, self.mesh, [0], spots=spots).render(0, 240)
        changed = np.abs(painted - plain).max(axis=2) > 30
        self.assertGreater(changed.sum(), 20)
        self.assertLess(changed.sum(), 0.3 * np.sum(plain.min(axis=2) < 200))


class CurvedTriangles(unittest.TestCase):
    """Point-normal triangles on a sphere."""

    def test_sphere_is_rounder_and_keeps_its_nodes(self):
        points, triangles = make_icosphere(1)
        corners, normals = refine(points[triangles], points[triangles], 4)
        self.assertEqual(corners.shape, (16 * len(triangles), 3, 3))
        np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1.0, atol=1e-12)
        flat, _ = refine(points[triangles], points[triangles], 1)
        np.testing.assert_allclose(flat, points[triangles], atol=1e-12)
        first = corners.reshape(len(triangles), 16, 3, 3)[:, 0, 0]
        np.testing.assert_allclose(first, points[triangles][:, 0], atol=1e-12)
        volume = np.linalg.det(corners).sum() / 6.0 / (4.0 * np.pi / 3.0)
        coarse = np.linalg.det(points[triangles]).sum() / 6.0 / (4.0 * np.pi / 3.0)
        self.assertLess(coarse, 0.89)
        self.assertAlmostEqual(volume, 1.0, delta=0.02)


class Curves(unittest.TestCase):
    """What the curves mean."""

    def test_mean_of_axes_and_not_of_numbers(self):
        mean = compute_mean_inclination(np.array([[89.0, -89.0], [10.0, 20.0]]))
        self.assertAlmostEqual(abs(mean[0]), 90.0, delta=1e-9)
        self.assertAlmostEqual(mean[1], 15.0, delta=1e-9)

    def test_curve_is_cut_where_the_angle_passes_the_gradient_direction(self):
        times, angles = cut_at_right_angle(np.arange(3.0), np.array([-60.0, -80.0, 70.0]))
        np.testing.assert_allclose(angles, [-60.0, -80.0, -90.0, np.nan, 90.0, 70.0])
        np.testing.assert_allclose(times, [0.0, 1.0, 4.0 / 3.0, 4.0 / 3.0, 4.0 / 3.0, 2.0])
        times, angles = cut_at_right_angle(np.array([0.0, 1.0]), np.array([80.0, -80.0]))
        np.testing.assert_allclose(angles, [80.0, 90.0, np.nan, -90.0, -80.0])


if __name__ == "__main__":
    unittest.main()
