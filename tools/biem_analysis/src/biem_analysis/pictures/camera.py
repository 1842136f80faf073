"""A perspective camera that looks at the shear plane from the vorticity direction.

Knows points and pixels; knows no cells.
"""

import numpy as np


class Camera:
    """Maps points to pixels.

    Parameters
    ----------
    flow, gradient : int (0..2), axes that appear to the right and upward
    azimuth, elevation : degrees, turn of the view out of the shear plane
    distance : float, distance of the eye in units of the extent of the scene
    """

    def __init__(self, flow=0, gradient=2, azimuth=22.0, elevation=17.0, distance=3.2):
        right, up = np.eye(3)[flow], np.eye(3)[gradient]
        toward = np.cross(right, up)    # from the scene to an eye that sees `flow` to the right
        turn, lift = np.radians(azimuth), np.radians(elevation)
        ahead = np.cos(turn) * toward + np.sin(turn) * right
        self.right = np.cos(turn) * right - np.sin(turn) * toward
        self.toward = np.cos(lift) * ahead + np.sin(lift) * up
        self.up = np.cross(self.toward, self.right)
        self._distance = distance
        self._center = np.zeros(3)
        self._extent = 1.0
        self._scale, self._shift = 1.0, np.zeros(2)
        self.width = self.height = 1

    def fit(self, points, width, margin=0.02):
        """Choose place and zoom so that the points (n, 3) fill an image `width` pixels wide."""
        low, high = points.min(axis=0), points.max(axis=0)
        self._center = 0.5 * (low + high)
        self._extent = 0.5 * np.linalg.norm(high - low)
        self._scale, self._shift = 1.0, np.zeros(2)
        plane, _ = self.project(points)
        low, high = plane.min(axis=0), plane.max(axis=0)
        border = margin * (high - low).max()
        self._scale = width / (high[0] - low[0] + 2 * border)
        self._shift = -self._scale * (low - border)
        self.width = int(width)
        self.height = int(np.ceil(self._scale * (high[1] - low[1] + 2 * border)))
        return self

    def project(self, points):
        """Pixels (..., 2), x to the right and y downward, and depth (...,) from the eye, length."""
        local = np.asarray(points, dtype=float) - self._center
        depth = self._distance * self._extent - local @ self.toward
        zoom = self._distance * self._extent / depth
        plane = np.stack([local @ self.right * zoom, -(local @ self.up) * zoom], axis=-1)
        return self._scale * plane + self._shift, depth

    def compute_pixel_size(self, depth):
        """Length of one pixel at a depth, length."""
        return np.asarray(depth) / (self._distance * self._extent * self._scale)
