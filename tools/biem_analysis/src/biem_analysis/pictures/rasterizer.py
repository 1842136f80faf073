"""Z-buffer: which triangle, and which line, every pixel shows.

Knows pixels and depths; knows no light, colour or cells.
"""

import numpy as np

FRAGMENTS_PER_BATCH = 1_500_000


class PixelBuffer:
    """Nearest surface per pixel.

    Attributes (flattened, n_pixels = height * width)
    depth : float32 (n_pixels,), infinite where there is nothing
    triangle : int32 (n_pixels,), -1 where there is nothing
    weights : float32 (n_pixels, 3), barycentric coordinates in the triangle
    """

    def __init__(self, width, height):
        self.width, self.height = width, height
        n_pixels = width * height
        self.depth = np.full(n_pixels, np.inf, dtype=np.float32)
        self.triangle = np.full(n_pixels, -1, dtype=np.int32)
        self.weights = np.zeros((n_pixels, 3), dtype=np.float32)

    def add_triangles(self, pixels, depth):
        """Draw triangles: pixels (n, 3, 2) and depths (n, 3) of their corners.

        Triangles seen from behind are left out: the surfaces are closed.
        """
        one, two = pixels[:, 1] - pixels[:, 0], pixels[:, 2] - pixels[:, 0]
        twice_area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        low = np.floor(pixels.min(axis=1) - 0.5).astype(np.int64)
        size = np.ceil(pixels.max(axis=1) + 0.5).astype(np.int64) - low
        front = np.flatnonzero(twice_area < -1e-9)
        side = 2 ** np.ceil(np.log2(np.maximum(size[front].max(axis=1), 1))).astype(int)
        for square in np.unique(side):
            members = front[side == square]
            batch = max(1, FRAGMENTS_PER_BATCH // (square * square))
            for begin in range(0, len(members), batch):
                chosen = members[begin:begin + batch]
                self._add_batch(chosen, pixels[chosen], depth[chosen], low[chosen], square)

    def _add_batch(self, names, corners, depth, low, square):
        """Draw triangles whose pixels lie in squares of the side `square` at `low` (n, 2)."""
        y, x = np.divmod(np.arange(square * square), square)
        px, py = low[:, :1] + x, low[:, 1:] + y
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        dx, dy = px + 0.5 - corners[:, :1, 0], py + 0.5 - corners[:, :1, 1]
        second = (dx * two[:, 1:] - dy * two[:, :1]) / area[:, None]
        third = (one[:, :1] * dy - one[:, 1:] * dx) / area[:, None]
        first = 1.0 - second - third
        inside = ((np.minimum(np.minimum(first, second), third) >= 0.0)
                  & (px >= 0) & (px < self.width) & (py >= 0) & (py < self.height))
        row, column = np.nonzero(inside)
        weights = np.column_stack([part[row, column] for part in (first, second, third)])
        self._keep_nearest((py * self.width + px)[row, column],
                           (weights * depth[row]).sum(axis=1), names[row], weights)

    def _keep_nearest(self, pixel, depth, names, weights):
        order = np.lexsort((depth, pixel))
        pixel, depth = pixel[order], depth[order]
        nearest = np.ones(len(pixel), dtype=bool)
        nearest[1:] = pixel[1:] != pixel[:-1]
        nearest &= depth < self.depth[pixel]
        order, pixel = order[nearest], pixel[nearest]
        self.depth[pixel] = depth[nearest]
        self.triangle[pixel] = names[order]
        self.weights[pixel] = weights[order]


def compute_line_cover(camera, buffer, begin, end, thickness):
    """How much of every pixel a straight line covers that surfaces may hide.

    Parameters
    ----------
    begin, end : array (3,), length
    thickness : float, pixels

    Returns
    -------
    pixel : int array (m,), flattened pixels touched;  hidden : bool array (m,)
    """
    (start, stop), _ = camera.project(np.array([begin, end]))
    n_points = int(2 * np.hypot(*(stop - start))) + 2
    points = np.asarray(begin) + np.linspace(0, 1, n_points)[:, None] * (
        np.asarray(end) - np.asarray(begin))
    place, depth = camera.project(points)
    reach = int(np.ceil(0.5 * thickness))
    offset = np.arange(-reach, reach + 1)
    disc = np.stack(np.meshgrid(offset, offset), axis=-1).reshape(-1, 2)
    disc = disc[np.hypot(*disc.T) <= max(0.5 * thickness, 0.5)]
    pixel = (np.floor(place).astype(np.int64)[:, None] + disc).reshape(-1, 2)
    depth = np.repeat(depth, len(disc))
    inside = np.all((pixel >= 0) & (pixel < [buffer.width, buffer.height]), axis=1)
    pixel = pixel[inside] @ [1, buffer.width]
    pixel, first = np.unique(pixel, return_index=True)
    return pixel, depth[inside][first] > buffer.depth[pixel]
