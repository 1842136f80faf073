"""CrossProfile: volume fraction of the cells and velocity of the fluid against a coordinate.

Knows bins across the box and which atoms are points in the flow; draws nothing.
"""

import csv

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase

from .cell_mesh import CellMesh, select_types
from .errors import BiemAnalysisError
from .polyhedron import compute_volume_below
from .trajectory import get_box, get_positions

AXIS_NAMES = "xyz"


class CrossProfile(AnalysisBase):
    """Profiles across a channel, in bins of equal width over the height of the box.

    Parameters
    ----------
    universe : MDAnalysis.Universe
        made by `biem_analysis.universe`
    axis : str
        'x', 'y' or 'z', the coordinate of the profile
    n_bins : int
    types : list of int, optional
        atom types of the cells that count; default: all atoms with triangles
    points : list of int, optional
        atom types of points in the flow (fix biem: probes or tracers); default: no velocity
    flow : str
        'x', 'y' or 'z', the component of the velocity
    verbose : bool
        show progress

    After `run()`, `results` holds

    edges : (n_bins + 1,), length, of the bins;  centers : (n_bins,)
    times : (n_frames,)
    volume_fraction : (n_frames, n_bins), of the solids that the flat triangles bound, exact
    velocity : (n_frames, n_bins), mean over the points in the bin, NaN where there are none
    """

    def __init__(self, universe, axis="z", n_bins=24, types=None, points=None, flow="x",
                 verbose=False):
        super().__init__(universe.trajectory, verbose=verbose)
        for letter in (axis, flow):
            if len(letter) != 1 or letter not in AXIS_NAMES:
                raise BiemAnalysisError(f"direction '{letter}' is not x, y or z")
        if n_bins < 1:
            raise BiemAnalysisError(f"{n_bins} bins: at least one is needed")
        self._axis, self._flow = AXIS_NAMES.index(axis), AXIS_NAMES.index(flow)
        self._n_bins = n_bins
        self.mesh = CellMesh(universe, types)
        self._points = None
        if points is not None:
            self._points = np.flatnonzero(select_types(universe, points))

    def _prepare(self):
        if self.n_frames == 0:
            raise BiemAnalysisError("no frame of the trajectory is selected; check start and stop")
        _, height, low = self._load()
        self.results.edges = low + height * np.linspace(0.0, 1.0, self._n_bins + 1)
        self.results.centers = 0.5 * (self.results.edges[1:] + self.results.edges[:-1])
        self.results.times = np.zeros(self.n_frames)
        for name in ("volume_fraction", "velocity"):
            self.results[name] = np.full((self.n_frames, self._n_bins), np.nan)

    def _load(self):
        """Positions (n_atoms, 3), height and lower end of the box along the axis."""
        box, origin = get_box(self._trajectory.ts)
        tilt = np.delete(box[:, self._axis], self._axis)
        if np.any(tilt != 0.0):
            raise BiemAnalysisError(
                f"the box is tilted along {AXIS_NAMES[self._axis]} by {tilt[tilt != 0.0][0]:g}: "
                "bins across it would not repeat; choose another axis")
        height = box[self._axis, self._axis]
        return get_positions(self._trajectory.ts), height, origin[self._axis]

    def _single_frame(self):
        i, results = self._frame_index, self.results
        positions, height, low = self._load()
        results.times[i] = self._ts.time
        results.volume_fraction[i] = self._compute_volume_fraction(positions, height, low)
        if self._points is not None:
            results.velocity[i] = self._compute_velocity(positions, height, low)

    def _compute_volume_fraction(self, positions, height, low):
        """Volume fraction (n_bins,) of the cells and of their periodic images."""
        mean = self.mesh.mean_over_nodes(positions)[self.mesh.triangle_cell]
        vertices = positions[self.mesh.triangles]
        shift = np.floor((mean[:, self._axis] - low) / height) * height
        heights = vertices[:, :, self._axis] - shift[:, None]
        overhang = max(low - heights.min(), heights.max() - low - height)
        reach = max(0, int(np.ceil(overhang / height)))
        below = sum(compute_volume_below(vertices, heights + k * height, self._axis,
                                         self.results.edges) for k in range(-reach, reach + 1))
        box, _ = get_box(self._ts)
        return np.diff(below) * self._n_bins / abs(np.linalg.det(box))

    def _compute_velocity(self, positions, height, low):
        """Mean velocity (n_bins,) of the points along the flow."""
        if not self._ts.has_velocities:
            raise BiemAnalysisError("the dump has no velocities; write it with vx vy vz")
        place = (positions[self._points, self._axis] - low) / height
        found = np.minimum(((place - np.floor(place)) * self._n_bins).astype(int),
                           self._n_bins - 1)
        count = np.bincount(found, minlength=self._n_bins)
        speed = self._ts.velocities[self._points, self._flow].astype(float)
        total = np.bincount(found, speed, self._n_bins)
        return np.divide(total, count, out=np.full(self._n_bins, np.nan), where=count > 0)

    def write_csv(self, path):
        """Write one row per bin: center, means over the frames; columns as in the manual."""
        if "edges" not in self.results:
            raise BiemAnalysisError("there are no results yet; call run() before write_csv()")
        with open(path, "w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow([AXIS_NAMES[self._axis], "volume_fraction", "velocity"])
            for row in zip(self.results.centers, self.results.volume_fraction.mean(axis=0),
                           self.results.velocity.mean(axis=0)):
                writer.writerow([f"{value:.10g}" for value in row])
