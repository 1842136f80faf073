"""Synthetic cells, data files and dumps with known answers for the tests of biem_analysis."""

import os
import sys

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SOURCE = os.path.join(ROOT, "tools", "biem_analysis", "src")
sys.path.insert(0, SOURCE)


def make_icosphere(n_subdivisions):
    """Unit sphere of 10 * 4^n + 2 nodes; triangles counter-clockwise from outside."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = [(s, t * golden) for s in (-1, 1) for t in (-1, 1)]
    nodes = np.array([np.roll((0.0, *pair), k) for k in range(3) for pair in corners])
    distance = np.linalg.norm(nodes[:, None] - nodes[None], axis=2)
    near = (distance > 0.1) & (distance < 2.1)
    triangles = [(a, b, c) for a in range(12) for b in range(a) for c in range(b)
                 if near[a, b] and near[b, c] and near[a, c]]
    nodes = [tuple(node) for node in nodes]
    for _ in range(n_subdivisions):
        middle = {}

        def halve(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(nodes)
                nodes.append(tuple(0.5 * (np.array(nodes[a]) + np.array(nodes[b]))))
            return middle[key]

        triangles = [part for a, b, c in triangles
                     for ab, bc, ca in [(halve(a, b), halve(b, c), halve(c, a))]
                     for part in [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]]
        nodes = [tuple(np.array(node) / np.linalg.norm(node)) for node in nodes]
    nodes, triangles = np.array(nodes), np.array(triangles)
    nodes /= np.linalg.norm(nodes, axis=1)[:, None]
    inward = np.linalg.det(nodes[triangles]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return nodes, triangles


def make_discocyte(sphere_nodes):
    """The resting red cell on the nodes of a unit sphere; symmetry axis z, volume 4 pi/3."""
    rho = np.hypot(sphere_nodes[:, 0], sphere_nodes[:, 1])
    alpha, sine2 = 1.3858189, rho ** 2
    height = 0.5 * alpha * (0.207 + 2.003 * sine2 - 1.123 * sine2 ** 2) * sphere_nodes[:, 2]
    return np.column_stack([alpha * sphere_nodes[:, 0], alpha * sphere_nodes[:, 1], height])


def rotate_y(points, degrees):
    """Turn from z toward x by the angle (about +y)."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    x, y, z = points.T
    return np.column_stack([cosine * x + sine * z, y, cosine * z - sine * x])


class Files:
    """Writes data and dump files of cells that share one mesh.

    cells : int, number of cells;  triangles : (n, 3) of one cell;  n_nodes : of one cell
    kinds : int array (n_atoms,), molecule and type of each atom; default: all of type 1
    """

    def __init__(self, folder, triangles, n_nodes, n_cells, kinds=None):
        self.folder, self.triangles = folder, triangles
        self.n_nodes, self.n_cells, self.kinds = n_nodes, n_cells, kinds

    def label(self, atom):
        """Molecule and type of an atom, as text."""
        if self.kinds is None:
            return f"{atom // self.n_nodes + 1} 1"
        return f"{self.kinds[atom]} {self.kinds[atom]}"

    def write_data(self, positions, extra="", box=(12, 12, 12), name="cells.data",
                   triangles=None):
        """Data file; `extra` is text inserted between the sections."""
        mesh = self.triangles if triangles is None else triangles
        angles = np.concatenate([mesh + 1 + c * self.n_nodes for c in range(self.n_cells)])
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as out:
            out.write("LAMMPS data file via write_data\n\n"
                      f"{len(positions)} atoms\n4 atom types\n{len(angles)} angles\n"
                      "1 angle types\n3 extra special per atom\n\n")
            for length, axis in zip(box, "xyz"):
                out.write(f"0 {length} {axis}lo {axis}hi\n")
            out.write(f"0 0 0 xy xz yz\n\nMasses\n\n1 1\n2 1\n3 1\n4 1\n\n{extra}Atoms # molecular\n\n")
            for i in np.random.default_rng(1).permutation(len(positions)):
                x, y, z = positions[i]
                out.write(f"{i + 1} {self.label(i)} {x:.12g} {y:.12g} {z:.12g} 0 0 0\n")
            if len(angles):
                out.write("\nAngles\n\n")
                for i, (a, b, c) in enumerate(angles):
                    out.write(f"{i + 1} 1 {a} {b} {c}\n")
        return path

    def write_dump(self, frames, tilts=None, box=(12, 12, 12), name="cells.dump",
                   columns="id mol type xu yu zu vx vy vz", every=100, shear_rate=0.0):
        """Dump of positions (n_frames, n_atoms, 3), triclinic with tilt xz if tilts are given.

        The velocities are (shear_rate z, 0, 0).
        """
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as out:
            for k, positions in enumerate(frames):
                out.write(f"ITEM: TIMESTEP\n{k * every}\nITEM: NUMBER OF ATOMS\n"
                          f"{len(positions)}\n")
                tilt = 0.0 if tilts is None else tilts[k]
                if tilts is None:
                    out.write("ITEM: BOX BOUNDS pp pp pp\n")
                    out.writelines(f"0 {length}\n" for length in box)
                else:
                    out.write("ITEM: BOX BOUNDS xy xz yz pp pp pp\n"
                              f"{min(0, tilt):.15g} {box[0] + max(0, tilt):.15g} 0\n"
                              f"0 {box[1]} {tilt:.15g}\n0 {box[2]} 0\n")
                out.write(f"ITEM: ATOMS {columns}\n")
                for i, (x, y, z) in enumerate(positions):
                    out.write(f"{i + 1} {self.label(i)} {x:.12g} {y:.12g} {z:.12g} "
                              f"{shear_rate * z:.12g} 0 0\n")
        return path
