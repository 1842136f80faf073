"""What became of the surfaces: volumes, areas, angles, gaps and crossings of triangle meshes.
Knows nothing of scenes and of LAMMPS but the layout of its dump and data files."""

import itertools
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

REACH = 0.5    # surfaces farther apart than this are not looked at


def read_triangles(path):
    """Atom IDs of the three nodes of every angle of a data file, n x 3."""
    text = Path(path).read_text()
    rows = text[text.index("\nAngles") + 1:].split("\n\n")[1]
    return np.array([line.split()[2:5] for line in rows.splitlines()], dtype=int)


class Frame:
    """Step, cell matrix (lattice vectors are rows); id, molecule, type, position of the atoms."""

    def __init__(self, lines):
        self.step = int(lines[1])
        bounds = [[float(word) for word in line.split()] for line in lines[5:8]]
        tilt = [row[2] if len(row) > 2 else 0.0 for row in bounds]
        xy, xz, yz = tilt
        leans = (0.0, xy, xz, xy + xz), (0.0, yz), (0.0,)
        sides = [high - max(lean) - low + min(lean)
                 for (low, high, *_), lean in zip(bounds, leans)]
        self.lattice = np.array([[sides[0], 0, 0], [xy, sides[1], 0], [xz, yz, sides[2]]])
        rows = np.array([line.split() for line in lines[9:]], dtype=float)
        self.ids, self.molecules = rows[:, 0].astype(int), rows[:, 1].astype(int)
        self.types, self.positions = rows[:, 2].astype(int), rows[:, 3:6]


def read_frames(path):
    parts = Path(path).read_text().split("ITEM: TIMESTEP\n")[1:]
    return [Frame(("ITEM: TIMESTEP\n" + part).splitlines()) for part in parts]


WALL = 3    # atom type


class Surfaces:
    """Nodes and triangles of every molecule; nodes count from 0 in the order of the IDs."""

    def __init__(self, frame, triangle_ids):
        index = np.zeros(frame.ids.max() + 1, dtype=int)
        index[frame.ids] = np.arange(len(frame.ids))
        triangles = index[triangle_ids]
        owners = frame.molecules[triangles[:, 0]]
        self.triangles = {m: triangles[owners == m] for m in np.unique(owners)}
        self.types = {m: frame.types[t[0, 0]] for m, t in self.triangles.items()}

    def molecules_of_type(self, number):
        return [m for m, kind in self.types.items() if kind == number]


def compute_volume(x, triangles):
    a, b, c = (x[triangles[:, k]] - x[triangles[0, 0]] for k in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def compute_areas(x, triangles):
    a, b, c = (x[triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def compute_smallest_angle(x, triangles):
    """Degrees."""
    angles = []
    for k in range(3):
        a, b, c = (x[triangles[:, (k + j) % 3]] for j in range(3))
        u, v = b - a, c - a
        angles.append(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), np.sum(u * v, axis=1)))
    return float(np.degrees(np.min(angles)))


def distances_to_triangles(p, a, b, c):
    """Row by row: point and triangle, each n x 3."""
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = np.sum((p - a) * normal, axis=1)
    foot = p - height[:, None] * normal
    is_inside = np.ones(len(p), dtype=bool)
    nearest = np.full(len(p), np.inf)
    for u, v in ((a, b), (b, c), (c, a)):
        edge = v - u
        is_inside &= np.sum(np.cross(edge, foot - u) * normal, axis=1) >= 0.0
        s = np.clip(np.sum((p - u) * edge, axis=1) / np.sum(edge * edge, axis=1), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(p - u - s[:, None] * edge, axis=1))
    return np.where(is_inside, np.abs(height), nearest)


def winding_numbers(points, corners):
    """Solid angle of a closed surface over 4 pi: 1 inside, 0 outside."""
    found = []
    for p in points:
        a, b, c = (corners[:, k] - p for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        above = np.sum(a * np.cross(b, c), axis=1)
        below = (la * lb * lc + np.sum(a * b, axis=1) * lc + np.sum(b * c, axis=1) * la
                 + np.sum(c * a, axis=1) * lb)
        found.append(np.sum(np.arctan2(above, below)) / (2.0 * np.pi))
    return np.array(found)


def gather_corners(x, triangles, frame):
    """n x 3 x 3, the corners of a triangle next to each other, also across periodic boundaries."""
    corners = x[triangles]
    across = corners - corners[:, :1]
    return corners[:, :1] + across + lattice_shifts(across, frame)


def lattice_shifts(x, frame):
    """Lattice vectors that bring points into the cell around the origin."""
    return -np.round(x @ np.linalg.inv(frame.lattice)) @ frame.lattice


def find_middles(corners):
    """Of all edges, once."""
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3)
    return middles[np.unique(np.round(middles, 9), axis=0, return_index=True)[1]]


def find_contacts(frame, surfaces):
    """(least distance of two surfaces or of two images, up to REACH; number of points inside
    another closed surface). Points are nodes and middles of edges, against triangles."""
    least, inside = REACH, 0
    shifts = [np.array(n) @ frame.lattice for n in itertools.product((-2, -1, 0, 1, 2), repeat=3)]
    points_of, corners = {}, {}
    for m, triangles in surfaces.triangles.items():
        x = frame.positions[np.unique(triangles)]
        home = lattice_shifts(x.mean(axis=0), frame)
        corners[m] = gather_corners(frame.positions, triangles, frame) + home
        points_of[m] = np.vstack((x + home, find_middles(corners[m])))
    for (one, other), shift in itertools.product(itertools.product(corners, corners), shifts):
        if (one == other and not np.any(shift)) or surfaces.types[one] == WALL:
            continue
        points, flat = points_of[one] + shift, corners[other].reshape(-1, 3)
        points = points[np.all((points > flat.min(axis=0) - REACH)
                               & (points < flat.max(axis=0) + REACH), axis=1)]
        if len(points) == 0:
            continue
        near, distance = distances_to_surface(points, corners[other])
        least = min(least, float(distance.min(initial=REACH)))
        if surfaces.types[other] != WALL:
            # A surface that enters another one has points near it: within one of its edges.
            edge = np.linalg.norm(corners[other] - np.roll(corners[other], 1, axis=1), axis=2).max()
            close = points[near[distance < edge]]
            inside += int(np.sum(winding_numbers(close, corners[other]) > 0.5))
    return least, inside


def distances_to_surface(points, corners):
    """Points (indices) with a triangle within REACH, and the distance of each."""
    a, b, c = (corners[:, k] for k in range(3))
    centers = (a + b + c) / 3.0
    radius = float(np.max([np.linalg.norm(v - centers, axis=1) for v in (a, b, c)]))
    lists = cKDTree(centers).query_ball_point(points, REACH + radius)
    near, distance = [], []
    for i, found in enumerate(lists):
        if found:
            p = np.broadcast_to(points[i], (len(found), 3))
            near.append(i)
            distance.append(distances_to_triangles(p, a[found], b[found], c[found]).min())
    return np.array(near, dtype=int), np.array(distance)
