"""The scene: cells wrapped into the periodic box, the box as a wireframe, seen by the camera.

Knows frames of a Universe and colours; the renderer below it knows neither.
"""

import itertools
from typing import NamedTuple

import numpy as np

from ..trajectory import get_box, get_positions
from .camera import Camera
from .paint import choose_colors
from .rasterizer import PixelBuffer, compute_line_cover
from .shading import (compute_contact_shadow, find_outlines, shade, to_linear, to_screen)
from .smooth import refine

BACKGROUND = (1.0, 1.0, 1.0)
BOX_COLOR = (0.30, 0.34, 0.40)
PAINT_COLOR = (1.0, 0.93, 0.72)
EDGE_OF_PAINT = 8.0      # the paint is full at 1/8 of its radius from its edge
SAMPLES = 2              # pixels rendered per side of an image pixel
FINE_MESH = 2500         # triangles of a cell from which on its outline looks smooth


def wrap_cells(positions, mesh, box, origin):
    """Positions (n_atoms, 3) with every cell moved by box edges until its mean is in the box."""
    fraction = (mesh.mean_over_nodes(positions) - origin) @ np.linalg.inv(box)
    wrapped = positions.copy()
    wrapped[mesh.nodes] -= (np.floor(fraction) @ box)[mesh.node_cell]
    return wrapped


def compute_box_corners(box, origin):
    """Corners (2, 2, 2, 3) of the box."""
    steps = np.array(list(itertools.product((0, 1), repeat=3)))
    return (origin + steps @ box).reshape(2, 2, 2, 3)


def list_box_edges(corners):
    """The 12 edges of the box as pairs of corners."""
    for axis in range(3):
        for one, two in itertools.product((0, 1), repeat=2):
            ends = [np.insert((one, two), axis, side) for side in (0, 1)]
            yield corners[tuple(ends[0])], corners[tuple(ends[1])]


def compute_node_normals(positions, triangles):
    """Unit normals (n_atoms, 3): mean over the triangles at a node, weighted by area."""
    corner = positions[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    total = np.zeros_like(positions)
    for k in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(triangles[:, k], normal[:, axis], len(positions))
    return total / np.maximum(np.linalg.norm(total, axis=1), 1e-300)[:, None]


class Surface(NamedTuple):
    """The triangles that are drawn."""

    corners: np.ndarray    # (n, 3, 3), length
    normals: np.ndarray    # (n, 3, 3), unit
    cell: np.ndarray       # (n,)
    paint: np.ndarray      # (n, 3), positive inside the painted spot


class SceneRenderer:
    """Renders frames of a Universe with one camera and one colour per cell.

    Parameters
    ----------
    universe : MDAnalysis.Universe
    mesh : CellMesh
    frames : list of int, the frames that will be rendered, in one scale that fits all of them
    flow, gradient : int, axes to the right and upward
    spots : Spots, optional, painted spots that move with the membranes
    """

    def __init__(self, universe, mesh, frames, flow=0, gradient=2, spots=None):
        self._universe, self._mesh = universe, mesh
        self._flow, self._gradient = flow, gradient
        largest = np.bincount(mesh.triangle_cell).max()
        self._n_parts = int(np.clip(np.ceil(np.sqrt(FINE_MESH / largest)), 1, 4))
        self._paint = self._make_paint(spots)
        self.colors = choose_colors(mesh.types)
        self._points = np.concatenate([self._collect_points(frame) for frame in frames])

    def _load(self, frame):
        """Wrapped positions and box corners of a frame, relative to the middle of the box."""
        timestep = self._universe.trajectory[frame]
        box, origin = get_box(timestep)
        positions = wrap_cells(get_positions(timestep), self._mesh, box, origin)
        corners = compute_box_corners(box, origin)
        middle = corners.mean(axis=(0, 1, 2))
        return positions - middle, corners - middle

    def _collect_points(self, frame):
        positions, corners = self._load(frame)
        return np.concatenate([positions[self._mesh.nodes], corners.reshape(-1, 3)])

    def make_camera(self, width):
        """A camera that sees all frames in images `width` pixels wide."""
        return Camera(self._flow, self._gradient).fit(self._points, width)

    def render(self, frame, width):
        """8-bit RGB image (height, width, 3) of a frame."""
        positions, corners = self._load(frame)
        camera = self.make_camera(SAMPLES * width)
        buffer = PixelBuffer(camera.width, camera.height)
        surface = self._make_surface(positions)
        buffer.add_triangles(*camera.project(surface.corners))
        image = np.tile(to_linear(BACKGROUND), (len(buffer.depth), 1))
        if np.any(buffer.triangle >= 0):
            self._draw_cells(image, buffer, camera, surface, corners)
        self._draw_box(image, buffer, camera, corners)
        return to_screen(image.reshape(camera.height, camera.width, 3), SAMPLES)

    def _refine(self, positions):
        """Corners and normals (n, 3, 3) of the curved surfaces through the nodes."""
        triangles = self._mesh.triangles
        normals = compute_node_normals(positions, triangles)
        return refine(positions[triangles], normals[triangles], self._n_parts)

    def _make_paint(self, spots):
        """Paint at the corners of the drawn triangles, (n, 3); there is some where it is > 0."""
        cell = np.repeat(self._mesh.triangle_cell, self._n_parts ** 2)
        if spots is None:
            return np.full((len(cell), 3), -1.0)
        return spots.compute_paint(self._refine(spots.positions)[0], cell)

    def _make_surface(self, positions):
        cell = np.repeat(self._mesh.triangle_cell, self._n_parts ** 2)
        return Surface(*self._refine(positions), cell, self._paint)

    def _draw_cells(self, image, buffer, camera, surface, corners):
        seen = np.flatnonzero(buffer.triangle >= 0)
        depth = buffer.depth[seen]
        normal, color = self._collect_surface(buffer, camera, surface, seen)
        size = self._estimate_cell_size(surface)
        pixel = float(camera.compute_pixel_size(np.median(depth)))
        layer = buffer.depth.reshape(camera.height, camera.width)
        shadow = compute_contact_shadow(layer, 0.35 * size / pixel, 1.2 * size).ravel()[seen]
        edge = np.where(find_outlines(layer, 0.15 * size).ravel()[seen], 0.55, 1.0)
        _, box_depth = camera.project(corners)
        haze = (depth - box_depth.min()) / (box_depth.max() - box_depth.min())
        haze = 0.28 * np.clip(haze, 0.0, 1.0)[:, None]
        light = shade(normal, color) * (shadow * edge)[:, None]
        image[seen] = (1.0 - haze) * light + haze * to_linear(BACKGROUND)

    def _collect_surface(self, buffer, camera, surface, seen):
        """Normals in the camera's frame and linear colours of the pixels `seen`, (n, 3) each."""
        name, weight = buffer.triangle[seen], buffer.weights[seen]
        normal = np.einsum("nk,nki->ni", weight, surface.normals[name])
        normal = normal @ np.column_stack([camera.right, camera.up, camera.toward])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        paint = np.einsum("nk,nk->n", weight, surface.paint[name])
        paint = np.clip(EDGE_OF_PAINT * paint, 0.0, 1.0)[:, None]
        color = to_linear(self.colors)[surface.cell[name]]
        return normal, (1.0 - paint) * color + paint * to_linear(PAINT_COLOR)

    def _estimate_cell_size(self, surface):
        """Typical radius of a cell from its surface area, length."""
        edges = surface.corners[:, 1:] - surface.corners[:, :1]
        area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum()
        return float(np.sqrt(area / (4.0 * np.pi * self._mesh.n_cells)))

    def _draw_box(self, image, buffer, camera, corners):
        thickness = max(1.0, camera.width / 900.0)
        for begin, end in list_box_edges(corners):
            pixel, hidden = compute_line_cover(camera, buffer, begin, end, thickness)
            strength = np.where(hidden, 0.0, 0.85)[:, None]
            image[pixel] = (1.0 - strength) * image[pixel] + strength * to_linear(BOX_COLOR)
