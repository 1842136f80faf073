"""create_cells in LAMMPS: atoms, angles, dihedrals and reference shape as written by LAMMPS, the
gap between cells from the dumped positions, equality on 1, 2 and 4 ranks, and bad input."""

import unittest

import numpy as np
from create_cases import CreateCase, read_dump
from lammps_scripts import HEADER

TYPES = "angle/types 1 dihedral/types 1"
BOX = "region box block -3 5 -4 4 -1 7\ncreate_box 1 box " + TYPES + "\nmass 1 1.0\n"
PRISM = "region box prism 0 7 0 7 0 7 0 3.4 0\ncreate_box 1 box " + TYPES + "\nmass 1 1.0\n"
# The membrane styles check the reference shape themselves, at 'run 0'.
MEMBRANE = """pair_style none
angle_style biem/skalak
angle_coeff * 1.0 100.0
dihedral_style biem/bend
dihedral_coeff * 0.0033 sphere
comm_modify cutoff 2.5
neighbor 0.2 bin
"""
OUTPUT = """compute angles all property/local aatom1 aatom2 aatom3 atype
compute hinges all property/local datom1 datom2 datom3 datom4 dtype
dump atoms all custom 1 atoms.dump id mol type xu yu zu d2_biem_reference[1] &
  d2_biem_reference[2] d2_biem_reference[3] mass
dump_modify atoms sort id format float %.17g
dump angles all local 1 angles.dump c_angles[1] c_angles[2] c_angles[3] c_angles[4]
dump hinges all local 1 hinges.dump c_hinges[1] c_hinges[2] c_hinges[3] c_hinges[4] c_hinges[5]
thermo_style custom step atoms angles dihedrals eangle edihed
thermo_modify format float %.15g
run 0
print "result $(atoms) $(eangle:%.15g) $(edihed:%.15g)"
"""
LJ = "pair_style lj/cut 1.0\npair_coeff * * 0.0 1.0\n"


def enclosed_volume(x, triangles):
    a, b, c = x[triangles[:, 0]], x[triangles[:, 1]], x[triangles[:, 2]]
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def triangle_distance(p, corners):
    """Smallest distance of the points p (n,3) from the triangles (m,3,3)."""
    best = np.full(len(p), np.inf)
    for corner in corners:
        normal = np.cross(corner[1] - corner[0], corner[2] - corner[0])
        normal /= np.linalg.norm(normal)
        above = np.ones(len(p), bool)
        distance = np.full(len(p), np.inf)
        for k in range(3):
            a, edge = corner[k], corner[(k + 1) % 3] - corner[k]
            above &= np.cross(edge, p - a) @ normal >= 0.0
            t = np.clip((p - a) @ edge / (edge @ edge), 0.0, 1.0)
            distance = np.minimum(distance, np.linalg.norm(p - a - t[:, None] * edge, axis=1))
        distance[above] = np.abs((p[above] - corner[0]) @ normal)
        best = np.minimum(best, distance)
    return best.min() if len(best) else np.inf


class CreateCells(CreateCase):
    command, box, output = "create_cells", BOX, MEMBRANE + OUTPUT

    def run_output(self, commands, n_ranks=1, box=None):
        """The dump of hinges too."""
        others = super().run_output(commands, n_ranks, box)
        return others + (read_dump(self.folder / "hinges.dump").astype(int),)


class OneCell(CreateCells):
    def test_topology_volume_and_place(self):
        _, atoms, angles, hinges = self.run_output("create_cells rbc nodes 162 single 1 2 3\n")
        self.assertEqual(len(atoms), 162)
        self.assertEqual(len(angles), 320)
        self.assertEqual(len(hinges), 480)
        np.testing.assert_array_equal(atoms[:, 0], np.arange(1, 163))
        self.assertTrue(np.all(atoms[:, 1:3] == 1))
        self.assertTrue(np.all(angles[:, 3] == 1) and np.all(hinges[:, 4] == 1))
        x = atoms[:, 3:6]
        volume = enclosed_volume(x - x[0], angles[:, :3] - 1)
        self.assertAlmostEqual(volume / (4.0 / 3.0 * np.pi), 1.0, places=12)
        np.testing.assert_allclose(x.mean(axis=0), [1, 2, 3], atol=1e-12)
        directed = {(t[k], t[(k + 1) % 3]): t[(k + 2) % 3] for t in angles[:, :3] for k in range(3)}
        self.assertEqual(len(directed), 960)
        for a, b, c, d in hinges[:, :4]:
            self.assertEqual(directed[(b, c)], a)
            self.assertEqual(directed[(c, b)], d)
        self.assertLessEqual(np.bincount(angles[:, 1]).max(), 2)
        self.assertLessEqual(np.bincount(hinges[:, 1]).max(), 3)

    def test_reference_is_the_unstressed_cell(self):
        text, atoms, _, _ = self.run_output(
            "create_cells rbc nodes 162 single 4.9 -4 7 orientation 1 1 0 roll 20\n")
        energy = float(text.split("result")[-1].split()[1])
        self.assertLess(abs(energy), 1e-20)
        x = atoms[:, 3:6] - atoms[:, 3:6].mean(axis=0)
        reference = atoms[:, 6:9] - atoms[:, 6:9].mean(axis=0)
        distances = [np.linalg.norm(y[:, None] - y[None], axis=2) for y in (x, reference)]
        np.testing.assert_allclose(distances[0], distances[1], atol=1e-12)
        # the symmetry axis is the direction of the smallest extent
        axis = np.linalg.eigh(x.T @ x)[1][:, 0]
        self.assertAlmostEqual(abs(axis @ [1, 1, 0]) / np.sqrt(2.0), 1.0, places=10)

    def test_shapes_and_sizes(self):
        a, c = 0.4965, 0.124
        flat = a - c
        rounded = 2 * np.pi * flat**2 * c + np.pi**2 * c**2 * flat + 4 / 3 * np.pi * c**3
        for shape, volume in (("sphere radius 0.401", 4 / 3 * np.pi * 0.401**3),
                              ("rbc radius 1.2", 4 / 3 * np.pi * 1.2**3),
                              ("platelet diameter 0.993 thickness 0.248", 4 / 3 * np.pi * a*a*c),
                              ("platelet diameter 0.993 thickness 0.248 edge rounded", rounded)):
            _, atoms, angles, _ = self.run_output(f"create_cells {shape} nodes 362 single 0 0 0\n")
            self.assertAlmostEqual(enclosed_volume(atoms[:, 3:6], angles[:, :3] - 1) / volume, 1.0,
                                   places=12, msg=shape)

    def test_labels(self):
        box = BOX.replace("create_box 1", "create_box 2").replace("/types 1", "/types 2")
        _, atoms, angles, hinges = self.run_output(
            "mass 2 1.0\ncreate_cells sphere nodes 42 single 0 0 0 type 2 angle_type 2 "
            "dihedral_type 2 molecule 7 group ball\ngroup check intersect ball all\n"
            "variable n equal count(check)\nprint \"in group $(v_n)\"\n", box=box)
        self.assertTrue(np.all(atoms[:, 2] == 2) and np.all(atoms[:, 1] == 7))
        self.assertTrue(np.all(angles[:, 3] == 2) and np.all(hinges[:, 4] == 2))
        self.assertIn("in group 42", (self.folder / "log.test").read_text())

    def test_bead(self):
        for arguments, radius in (("", 0.532), ("diameter 1.5", 0.75), ("radius 0.6", 0.6)):
            text, atoms, angles, _ = self.run_output(
                f"create_cells bead {arguments} nodes 162 single 0 0 0\n")
            self.assertAlmostEqual(enclosed_volume(atoms[:, 3:6], angles[:, :3] - 1) /
                                   (4 / 3 * np.pi * radius**3), 1.0, places=12)
            self.assertIn(f"sphere of radius {radius:g}", text)


class MeshFromFile(CreateCells):
    """An octahedron with unequal axes, given far from the origin; its center is that of volume."""

    semi_axes = np.array([0.9, 0.6, 0.4])
    corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (1, 0, 5), (2, 1, 5), (3, 2, 5), (0, 3, 5)]

    def write(self, faces=None, name="body.off"):
        faces = self.faces if faces is None else faces
        lines = [f"OFF\n6 {len(faces)} 0"]
        for corner in self.corners * self.semi_axes + [30, -20, 10]:
            lines.append("%.17g %.17g %.17g" % tuple(corner))
        lines += ["3 %d %d %d" % face for face in faces]
        (self.folder / name).write_text("\n".join(lines) + "\n")

    def write_stl(self):
        out = ["solid body"]
        for face in self.faces:
            out += ["facet normal 0 0 0", "outer loop"]
            for corner in (self.corners * self.semi_axes)[list(face)]:
                out.append("vertex %.17g %.17g %.17g" % tuple(corner))
            out += ["endloop", "endfacet"]
        (self.folder / "body.stl").write_text("\n".join(out + ["endsolid body"]) + "\n")

    def test_place_size_and_direction(self):
        self.write()
        self.write_stl()
        volume = 4.0 / 3.0 * self.semi_axes.prod()
        for name in ("body.off", "body.stl"):
            for size, factor in (("", 1.0), ("scale 1.5", 1.5),
                                 ("radius 0.8", 0.8 / np.cbrt(volume * 0.75 / np.pi))):
                text, atoms, angles, hinges = self.run_output(
                    f"create_cells mesh {name} {size} single 4.9 2 3 orientation 1 0 0\n")
                self.assertEqual((len(atoms), len(angles), len(hinges)), (6, 8, 12))
                x = atoms[:, 3:6]
                np.testing.assert_allclose(x.mean(axis=0), [4.9, 2, 3], atol=1e-12)
                self.assertAlmostEqual(enclosed_volume(x - x[0], angles[:, :3] - 1) /
                                       (volume * factor**3), 1.0, places=10)
                # the z axis of the file goes to x; the reference is the body in its own frame
                np.testing.assert_allclose(np.ptp(x, axis=0), 2 * factor *
                                           self.semi_axes[[2, 1, 0]], atol=1e-12)
                np.testing.assert_allclose(np.ptp(atoms[:, 6:9], axis=0),
                                           2 * factor * self.semi_axes, atol=1e-12)
                self.assertIn(f"mesh of {name}, equivalent radius", text)

    def test_same_on_1_2_and_4_ranks(self):
        self.write()
        results = []
        for n_ranks in (1, 2, 4):
            _, atoms, angles, hinges = self.run_output(
                "create_cells mesh body.off single 1 1 3 orientation 1 1 0 roll 30\n"
                "create_cells rbc nodes 42 random 6 3\n", n_ranks)
            results.append((atoms, angles[np.lexsort(angles.T)], hinges[np.lexsort(hinges.T)]))
        self.assertEqual(results[0][0][-1, 1], 7)
        for other in results[1:]:
            for one, two in zip(results[0], other):
                np.testing.assert_array_equal(one, two)

    def test_bad_input(self):
        self.write()
        self.write(self.faces[1:], "open.off")
        self.write([face[::-1] for face in self.faces], "inside_out.off")
        self.write([self.faces[0][::-1]] + self.faces[1:], "twisted.off")
        for arguments, message in (
                ("mesh body.off random 3 1", "can be placed with 'single x y z' only"),
                ("mesh body.off hematocrit 0.1 1", "can be placed with 'single x y z' only"),
                ("mesh body.off nodes 42 single 0 0 0", "nodes does not belong to mesh"),
                ("mesh body.off thickness 1 single 0 0 0", "thickness does not belong to mesh"),
                ("mesh body.off radius 1 scale 2 single 0 0 0", "both radius and scale"),
                ("mesh body.off", "a placement is missing"),
                ("mesh none.off single 0 0 0", "Mesh file none.off: cannot be opened"),
                ("mesh open.off single 0 0 0", "open at the edge between nodes"),
                ("mesh inside_out.off single 0 0 0", "the enclosed volume is -"),
                ("mesh twisted.off single 0 0 0", "oriented against each other"),
                ("mesh body.off scale 10 single 0 0 0", "half the shortest height of the box"),
                ("sphere scale 2 nodes 42 single 0 0 0", "scale does not belong to sphere"),
                ("bead radius 1 diameter 2 nodes 42 single 0 0 0", "both radius and diameter")):
            self.assert_refused(f"create_cells {arguments}\n", message)
        self.assert_refused("create_cells rbc nodes 162 single 0 0 0\n"
                            "create_cells mesh body.off single 0 0 0.6 gap 0.1\n",
                            "does not keep the gap 0.100000 to what is in the box", n_ranks=2)


class ManyCells(CreateCells):
    def check_gap(self, atoms, angles, lattice, n_nodes, gap):
        cells = atoms[:, 3:6].reshape(-1, n_nodes, 3)
        for i, own in enumerate(cells):
            rows = angles[(angles[:, 0] - 1) // n_nodes == i, :3] - 1 - i * n_nodes
            corners = own[rows]
            center = own.mean(axis=0)
            for j, other in enumerate(cells):
                for n in np.ndindex(5, 5, 5):
                    if i == j and n == (2, 2, 2):
                        continue
                    p = other + lattice @ (np.array(n) - 2)
                    if np.linalg.norm(p.mean(axis=0) - center) > 3.0:
                        continue
                    # only what is nearer than the gap and an edge (0.45) can break the gap
                    apart = np.linalg.norm(p[:, None] - corners.mean(axis=1)[None], axis=2)
                    near = apart < gap + 0.5
                    self.assertGreaterEqual(
                        triangle_distance(p[near.any(axis=1)], corners[near.any(axis=0)]), gap)

    def test_hematocrit_in_a_tilted_box(self):
        text, atoms, angles, _ = self.run_output(
            "create_cells rbc nodes 162 hematocrit 0.3 4711 gap 0.04\n", box=PRISM)
        n_cells = round(0.3 * 343 / (4 / 3 * np.pi))
        self.assertEqual(len(atoms), n_cells * 162)
        self.assertIn(f"Created {n_cells} cells", text)
        self.assertIn(f"(hematocrit) {n_cells * 4 / 3 * np.pi / 343:.6g}", text)
        np.testing.assert_array_equal(atoms[:, 1], (atoms[:, 0] - 1) // 162 + 1)
        lattice = np.array([[7, 0, 3.4], [0, 7, 0], [0, 0, 7]])
        self.check_gap(atoms, angles, lattice, 162, 0.04)
        energy = float(text.split("result")[-1].split()[1])
        self.assertLess(abs(energy), 1e-18)

    def test_same_on_1_2_and_4_ranks(self):
        commands = ("create_cells rbc nodes 162 random 6 99 gap 0.05\n"
                    "create_cells platelet diameter 0.993 thickness 0.248 nodes 42 random 10 3 "
                    "gap 0.02 type 1\n")
        room = BOX.replace(TYPES, TYPES + " extra/angle/per/atom 2 extra/dihedral/per/atom 3")
        results = []
        for n_ranks in (1, 2, 4):
            _, atoms, angles, hinges = self.run_output(commands, n_ranks, box=room)
            angles = angles[np.lexsort(angles.T)]
            hinges = hinges[np.lexsort(hinges.T)]
            results.append((atoms, angles, hinges))
        self.assertEqual(len(results[0][0]), 6 * 162 + 10 * 42)
        self.assertEqual(results[0][0][-1, 1], 16)
        for other in results[1:]:
            for one, two in zip(results[0], other):
                np.testing.assert_array_equal(one, two)

    def test_fixed_axis(self):
        _, atoms, _, _ = self.run_output(
            "create_cells rbc nodes 42 random 5 1 orientation 0 1 1\n")
        for cell in atoms[:, 3:6].reshape(5, 42, 3):
            x = cell - cell.mean(axis=0)
            axis = np.linalg.eigh(x.T @ x)[1][:, 0]
            self.assertAlmostEqual(abs(axis @ [0, 1, 1]) / np.sqrt(2.0), 1.0, places=10)

    def test_new_cells_avoid_existing_ones(self):
        _, atoms, angles, _ = self.run_output(
            "create_cells rbc nodes 162 single 4.5 3.8 6.8\n"
            "create_cells rbc nodes 162 hematocrit 0.25 8 gap 0.05\n")
        self.check_gap(atoms, angles, 8.0 * np.eye(3), 162, 0.05)
        self.assertEqual(atoms[-1, 1], 1 + round(0.25 * 512 / (4 / 3 * np.pi)))

    def test_new_cells_avoid_existing_points(self):
        room = BOX.replace(TYPES, TYPES + " extra/angle/per/atom 2 extra/dihedral/per/atom 3")
        room += "create_atoms 1 random 40 17 NULL\n"
        done = self.run_lammps(HEADER + room + "create_cells rbc nodes 162 random 4 5 gap 0.1\n" +
                               LJ + "dump a all custom 1 atoms.dump id mol xu yu zu\n"
                               "dump_modify a sort id format float %.15g\nrun 0\n")
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        atoms = read_dump(self.folder / "atoms.dump")
        points = atoms[:40, 2:]
        for k in range(4):
            nodes = atoms[40 + 162 * k:40 + 162 * (k + 1), 2:]
            self.assertEqual(atoms[40 + 162 * k, 1], k + 1)
            difference = points[:, None] - nodes[None]
            difference -= 8.0 * np.round(difference / 8.0)
            self.assertGreater(np.linalg.norm(difference, axis=2).min(), 0.1)

    def test_survives_write_data_and_restart(self):
        script = (HEADER + BOX + "create_cells rbc nodes 42 random 2 5\n" + MEMBRANE +
                  "run 0\nwrite_data cells.data nocoeff nofix\nwrite_restart cells.restart\n"
                  "print \"energy $(edihed:%.13g)\"\n")
        first = self.run_lammps(script)
        self.assertEqual(first.returncode, 0, first.stdout[-2000:])
        data = (self.folder / "cells.data").read_text()
        for line in ("84 atoms", "160 angles", "240 dihedrals"):
            self.assertIn(line, data)
        again = self.run_lammps("read_restart cells.restart\n"
                                "fix biem_reference all property/atom d2_biem_reference 3 "
                                "ghost yes\n" + MEMBRANE +
                                "run 0\nprint \"energy $(edihed:%.13g)\"\n")
        self.assertEqual(again.returncode, 0, again.stdout[-2000:] + again.stderr)
        energies = [run.stdout.split("energy ")[-1].split()[0] for run in (first, again)]
        self.assertEqual(energies[0], energies[1])


class BadInput(CreateCells):
    def test_arguments(self):
        for arguments, message in (
                ("", "ends too early"),
                ("cube nodes 42 single 0 0 0", "unknown shape 'cube'"),
                ("rbc single 0 0 0", "keyword nodes is missing"),
                ("rbc nodes 42", "a placement is missing"),
                ("rbc nodes 100 single 0 0 0", "the nearest counts are 92 and 162"),
                ("rbc nodes 42 single 0 0", "ends too early"),
                ("rbc nodes 42 single 0 0 0 random 3 1", "after another placement"),
                ("rbc nodes 42 nodes 42 single 0 0 0", "is given twice"),
                ("rbc nodes 42 single 0 0 0 colour red", "unknown keyword 'colour'"),
                ("rbc nodes 42 single 0 0 0 radius 0", "must be a positive number"),
                ("rbc nodes 42 single 0 0 0 diameter 1", "diameter does not belong to rbc"),
                ("platelet nodes 42 single 0 0 0 radius 1", "radius does not belong to platelet"),
                ("platelet nodes 42 single 0 0 0 diameter 1", "needs diameter and thickness"),
                ("platelet diameter 1 thickness 2 nodes 42 single 0 0 0", "exceeds the diameter"),
                ("platelet diameter 1 thickness 0.2 edge sharp nodes 42 single 0 0 0",
                 "unknown edge 'sharp'"),
                ("rbc nodes 42 single 0 0 0 orientation 0 0 0", "is no direction"),
                ("rbc nodes 42 single 0 0 0 orientation random", "needs a seed"),
                ("rbc nodes 42 random 2 7 roll 30", "roll turns a cell about a given axis"),
                ("rbc nodes 42 random 0 7", "must be 1 or more"),
                ("rbc nodes 42 random 2 0", "seed of random 0 must be 1 or more"),
                ("rbc nodes 42 hematocrit 30 7", "must be below 1"),
                ("rbc nodes 42 hematocrit 0.001 7", "means 0.12"),
                ("rbc nodes 42 random 2 7 gap -1", "gap must be 0 or a positive length"),
                ("rbc nodes 42 single 0 0 0 type 2", "atom type 2 does not exist"),
                ("rbc nodes 42 single 0 0 0 angle_type 2", "angle type 2 does not exist"),
                ("rbc nodes 42 single 0 0 0 dihedral_type 2", "dihedral type 2 does not exist"),
                ("rbc radius 4 nodes 12 single 0 0 0", "half the shortest height of the box"),
                ("rbc nodes 42 hematocrit 0.9 7", "cannot fit"),
                ("rbc radius 3.2 nodes 42 single 0 0 0", "to its own periodic image")):
            self.assert_refused(f"create_cells {arguments}\n", message)

    def test_no_room_says_how_many(self):
        box = "region box block 0 4 0 4 0 4\ncreate_box 1 box " + TYPES + "\n"
        self.assert_refused("create_cells rbc nodes 162 hematocrit 0.7 1\n",
                            "cannot place 11 bodies", "keep the gap (volume fraction",
                            box=box, n_ranks=2)

    def test_overlap_with_an_existing_cell(self):
        self.assert_refused("create_cells rbc nodes 42 single 0 0 0\n"
                            "create_cells rbc nodes 42 single 0 0 0.4\n", "does not keep the gap")

    def test_molecule_in_use(self):
        self.assert_refused("create_cells sphere nodes 42 single 0 0 0\n"
                            "create_cells sphere nodes 42 single 0 0 4 molecule 1\n",
                            "molecule 1", "next free molecule ID is 2")

    def test_no_room_for_topology(self):
        self.assert_refused("create_atoms 1 single 4 0 0\ncreate_cells rbc nodes 42 single 0 0 0\n",
                            "extra/angle/per/atom 2 extra/dihedral/per/atom 3")

    def test_foreign_property(self):
        self.assert_refused("fix mine all property/atom d_biem_reference\n"
                            "create_cells rbc nodes 42 single 0 0 0\n",
                            "not of the form d2_biem_reference")

    def test_system(self):
        cell = "create_cells rbc nodes 42 single 0 0 0\n"
        self.assert_refused(cell, "no box yet", box="")
        self.assert_refused(cell, "newton is off",
                            header=HEADER.replace("newton on", "newton off"))
        self.assert_refused(cell, "must be three-dimensional and periodic",
                            header=HEADER.replace("p p p", "p p f"))
        self.assert_refused(cell, "atom style atomic lacks",
                            header=HEADER.replace("molecular", "atomic"),
                            box="region box block -3 5 -4 4 -1 7\ncreate_box 1 box\n")
        self.assert_refused(cell, "atom style angle lacks",
                            header=HEADER.replace("molecular", "angle"),
                            box=BOX.replace("dihedral/types 1", ""))


if __name__ == "__main__":
    unittest.main()
