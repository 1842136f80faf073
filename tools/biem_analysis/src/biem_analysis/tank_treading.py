"""How far the membrane has turned around the cell: the phase of one marker node per cell.

Pure functions on arrays; knows nothing of files or MDAnalysis.
"""

import numpy as np


def choose_markers(positions, mesh, centroid, flow, gradient):
    """Marker node of each cell: the one farthest from the cell's line through the centroid
    along the vorticity, among the nodes that are nearest to the shear plane.

    Parameters
    ----------
    positions : array (n_atoms, 3), length
    mesh : CellMesh
    centroid : array (n_cells, 3), length
    flow, gradient : int, axes of the shear plane

    Returns
    -------
    int array (n_cells,), atom indices
    """
    vorticity = 3 - flow - gradient
    offset = positions[mesh.nodes] - centroid[mesh.node_cell]
    distance = np.hypot(offset[:, flow], offset[:, gradient])
    score = distance - 2.0 * np.abs(offset[:, vorticity])
    order = np.lexsort((score, mesh.node_cell))
    last = np.append(mesh.node_start[1:], len(mesh.nodes)) - 1
    return mesh.nodes[order[last]]


def compute_marker_angle(offset, cut, flow, gradient):
    """Angle of the markers in the frame of the cell's ellipse (EllipseCut), rad, modulo pi.

    The angle is that on the circle from which the ellipse is stretched, so that it grows evenly,
    and counts in the sense of the flow u = rate * gradient coordinate (from gradient to flow).
    """
    tilt = np.radians(cut.angle)
    along = np.cos(tilt) * offset[:, flow] + np.sin(tilt) * offset[:, gradient]
    across = -np.sin(tilt) * offset[:, flow] + np.cos(tilt) * offset[:, gradient]
    return -np.arctan2(across / cut.short_axis, along / cut.long_axis)


def unwrap_phase(angle):
    """Continuous phase, rad, from angles (n_frames, n_cells), rad, that are known modulo pi.

    The inclination jumps by 180 degrees when a cell passes the gradient direction; hence pi.
    The marker must turn by less than a quarter turn between frames.
    """
    if len(angle) == 0:
        return angle
    return np.unwrap(angle, axis=0, period=np.pi)


def compute_angular_frequency(times, phase):
    """Least-squares slope of the phase (n_frames, n_cells), rad per time, and its error.

    The error is the standard error of the slope for uncorrelated residuals: it understates the
    error where the phase oscillates with the turning.  NaN for fewer than three frames.
    """
    n_frames, n_cells = phase.shape
    if n_frames < 3:
        return np.full(n_cells, np.nan), np.full(n_cells, np.nan)
    time = times - times.mean()
    slope = time @ (phase - phase.mean(axis=0)) / (time @ time)
    residual = phase - phase.mean(axis=0) - np.outer(time, slope)
    error = np.sqrt((residual ** 2).sum(axis=0) / (n_frames - 2) / (time @ time))
    return slope, error
