"""CellShapes: the shape of every cell in every frame, as arrays and as a table.

Knows the order of work and the names of the results; the formulas are in polyhedron.py.
"""

import csv

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase

from .cell_mesh import CellMesh
from .errors import BiemAnalysisError
from .polyhedron import (compute_cell_axis, compute_cell_moments, compute_ellipse_cut,
                         compute_plane_angle, compute_semi_axes, compute_triangle_area)
from .tank_treading import (choose_markers, compute_angular_frequency, compute_marker_angle,
                            unwrap_phase)
from .trajectory import get_box, get_positions

AXIS_NAMES = "xyz"
TABLE_COLUMNS = (
    ("volume", "volume"), ("area", "area"),
    ("centroid_x", "centroid", 0), ("centroid_y", "centroid", 1), ("centroid_z", "centroid", 2),
    ("semi_axis_1", "semi_axes", 0), ("semi_axis_2", "semi_axes", 1),
    ("semi_axis_3", "semi_axes", 2),
    ("inclination_in_plane", "inclination_in_plane"), ("inclination_3d", "inclination_3d"),
    ("axis_x", "cell_axis", 0), ("axis_y", "cell_axis", 1), ("axis_z", "cell_axis", 2),
    ("ellipsoid_angle", "ellipsoid_angle"), ("taylor_deformation", "taylor_deformation"),
    ("area_strain_mean", "area_strain_mean"), ("area_strain_max", "area_strain_max"),
    ("phase", "phase"))


class CellShapes(AnalysisBase):
    """Volume, area, inclination, deformation and tank-treading of every cell in time.

    Parameters
    ----------
    universe : MDAnalysis.Universe
        made by `biem_analysis.universe`
    shear_plane : str
        flow direction and gradient direction, 'xz' for u_x = rate * z
    reference : array (n_atoms, 3), length, optional
        node positions of the shape against which area strain counts; default: the first frame
        analysed.  Only differences within a cell matter.
    verbose : bool
        show progress
    types : list of int, optional
        atom types of the cells; default: all atoms with triangles

    After `run()`, `results` holds for n_frames frames and n_cells cells (lengths in the LAMMPS
    length unit, angles in degrees unless stated):

    steps, times : (n_frames,)
    molecules : (n_cells,) molecule ids
    volume, area : (n_frames, n_cells), of the flat triangles, exact to rounding
    centroid : (n_frames, n_cells, 3), of the enclosed solid, unwrapped
    semi_axes : (n_frames, n_cells, 3), longest first, of the ellipsoid with the same second
        moments as the enclosed solid
    inclination_in_plane : (n_frames, n_cells), in (-90, 90], of the longest direction of the
        surface in the shear plane, from the flow toward the gradient direction
    cell_axis : (n_frames, n_cells, 3), unit eigenvector of the smallest moment of inertia of the
        surface (Zhao et al. 2012, Sec. III)
    inclination_3d : (n_frames, n_cells), in [0, 90], angle of `cell_axis` with the flow.  When
        the two long axes are nearly equal `cell_axis` may turn to the vorticity direction.
    ellipsoid_angle : (n_frames, n_cells), in (-90, 90], of the long axis of the cut of the
        ellipsoid with the shear plane
    taylor_deformation : (n_frames, n_cells), (L - B)/(L + B) of the semi-axes of that cut
    area_strain_mean, area_strain_max : (n_frames, n_cells), mean (by reference area) and largest
        |A/A_ref - 1| over the triangles of the cell
    phase : (n_frames, n_cells), rad, angle of a marker node around the cell in the frame of the
        cell, 0 at first; grows as the membrane tank-treads.  Frames must be closer than a
        quarter turn.
    angular_frequency, angular_frequency_error : (n_cells,), rad/time, slope of the phase and
        its standard error (see tank_treading.py)
    markers : (n_cells,) atom indices of the marker nodes

    Errors: the formulas are exact for the polyhedra (1e-12 with a dump of full precision; a dump
    with the default format %g has 6 digits, so positions near 1000 have an error of 0.005).
    """

    def __init__(self, universe, shear_plane="xz", reference=None, verbose=False,
                 types=None):
        super().__init__(universe.trajectory, verbose=verbose)
        if (len(shear_plane) != 2 or not set(shear_plane) <= set(AXIS_NAMES)
                or shear_plane[0] == shear_plane[1]):
            raise BiemAnalysisError(f"shear plane '{shear_plane}' is not two different letters of "
                                    "x, y, z; give flow and gradient direction, e.g. xz")
        self._flow, self._gradient = (AXIS_NAMES.index(letter) for letter in shear_plane)
        self._reference = reference
        self.mesh = CellMesh(universe, types)

    def _prepare(self):
        if self.n_frames == 0:
            raise BiemAnalysisError("no frame of the trajectory is selected; check start and stop")
        frames, cells = self.n_frames, self.mesh.n_cells
        self.results.molecules = self.mesh.molecules
        self.results.steps = np.zeros(frames, dtype=np.int64)
        self.results.times = np.zeros(frames)
        for name in ("volume", "area", "inclination_in_plane", "inclination_3d",
                     "ellipsoid_angle", "taylor_deformation", "area_strain_mean",
                     "area_strain_max", "phase"):
            self.results[name] = np.zeros((frames, cells))
        for name in ("centroid", "semi_axes", "cell_axis"):
            self.results[name] = np.zeros((frames, cells, 3))
        self._reference_area = None
        if self._reference is not None:
            self._set_reference(compute_triangle_area(
                np.asarray(self._reference, dtype=float)[self.mesh.triangles]))

    def _set_reference(self, area):
        if np.any(area <= 0):
            cell = self.mesh.triangle_cell[np.argmax(area <= 0)]
            raise BiemAnalysisError(f"molecule {self.mesh.molecules[cell]} has a triangle of no "
                                    "area in the reference shape; check the reference")
        self._reference_area = area

    def _single_frame(self):
        mesh, results, i = self.mesh, self.results, self._frame_index
        positions = get_positions(self._ts)
        vertices = positions[mesh.triangles]
        moments = compute_cell_moments(vertices, mesh.triangle_start, mesh.triangle_cell,
                                       mesh.mean_over_nodes(positions))
        self._check(vertices, moments)
        results.steps[i] = self._ts.data.get("step", self._ts.frame)
        results.times[i] = self._ts.time
        results.volume[i], results.area[i] = moments.volume, moments.area
        results.centroid[i] = moments.centroid
        results.semi_axes[i] = compute_semi_axes(moments.covariance)
        results.inclination_in_plane[i] = compute_plane_angle(
            moments.surface_covariance, self._flow, self._gradient)
        axis = compute_cell_axis(moments.surface_covariance)
        results.cell_axis[i] = axis
        results.inclination_3d[i] = np.degrees(
            np.arccos(np.clip(np.abs(axis[:, self._flow]), 0.0, 1.0)))
        self._store_area_strain(i, moments.triangle_area)
        self._store_cut(i, positions, moments)

    def _store_cut(self, i, positions, moments):
        """Deformation in the shear plane, and the marker's angle relative to that ellipse."""
        results = self.results
        cut = compute_ellipse_cut(moments.covariance, self._flow, self._gradient)
        results.ellipsoid_angle[i] = cut.angle
        results.taylor_deformation[i] = cut.taylor_deformation
        if i == 0:
            results.markers = choose_markers(positions, self.mesh, moments.centroid,
                                             self._flow, self._gradient)
        results.phase[i] = compute_marker_angle(positions[results.markers] - moments.centroid,
                                                cut, self._flow, self._gradient)

    def _check(self, vertices, moments):
        """Stop where a cell is torn by wrong images or turned inside out."""
        box, _ = get_box(self._ts)
        edges = np.abs(np.roll(vertices, -1, axis=1) - vertices).max(axis=(1, 2))
        torn = edges > 0.5 * np.diag(box).min()
        if np.any(torn):
            cell = self.mesh.triangle_cell[np.argmax(torn)]
            raise BiemAnalysisError(
                f"molecule {self.mesh.molecules[cell]} has an edge longer than half the box in "
                f"frame {self._ts.frame}: its nodes are in different periodic images; write the "
                "dump with xu yu zu and keep the image flags of the run; if it is a wall, "
                "name the atom types of the cells (--types)")
        if np.any(moments.volume <= 0):
            cell = np.argmax(moments.volume <= 0)
            raise BiemAnalysisError(
                f"molecule {self.mesh.molecules[cell]} has the volume {moments.volume[cell]:g} in "
                f"frame {self._ts.frame}: the cell has collapsed or turned inside out")

    def _store_area_strain(self, i, triangle_area):
        if self._reference_area is None:
            self._set_reference(triangle_area)
        change = np.abs(triangle_area - self._reference_area)
        self.results.area_strain_mean[i] = (
            self.mesh.sum_over_triangles(change)
            / self.mesh.sum_over_triangles(self._reference_area))
        self.results.area_strain_max[i] = np.maximum.reduceat(
            change / self._reference_area, self.mesh.triangle_start)

    def _conclude(self):
        phase = unwrap_phase(self.results.phase)
        self.results.phase = phase - phase[:1]
        slope, error = compute_angular_frequency(self.results.times, self.results.phase)
        self.results.angular_frequency = slope
        self.results.angular_frequency_error = error

    def write_csv(self, path):
        """Write one row per frame and cell; columns as in doc/biem_analysis.md."""
        if "molecules" not in self.results:
            raise BiemAnalysisError("there are no results yet; call run() before write_csv()")
        columns = [self.results[column[1]][(..., *column[2:])] for column in TABLE_COLUMNS]
        with open(path, "w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(["step", "time", "cell"] + [column[0] for column in TABLE_COLUMNS])
            for i, (step, time) in enumerate(zip(self.results.steps, self.results.times)):
                for j, molecule in enumerate(self.results.molecules):
                    writer.writerow([step, f"{time:.10g}", molecule]
                                    + [f"{column[i, j]:.10g}" for column in columns])
