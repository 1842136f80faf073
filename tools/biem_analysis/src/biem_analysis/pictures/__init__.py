"""Pictures of cells: a small software renderer and the figures made with it.

camera, smooth, rasterizer and shading know points, triangles and pixels only; scene knows cells and
the periodic box; figures know files, titles and matplotlib.
"""

from .figures import draw_final, draw_profile, draw_shapes, draw_snapshots
from .scene import SceneRenderer

__all__ = ["SceneRenderer", "draw_final", "draw_profile", "draw_shapes", "draw_snapshots"]
