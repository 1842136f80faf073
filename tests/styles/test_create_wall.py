"""create_wall in LAMMPS: atoms, angles and reference positions as written by LAMMPS, lattices that
repeat themselves, areas, room for what comes later, equality on 1, 2 and 4 ranks, and bad input."""

import unittest

import numpy as np
from create_cases import CreateCase, read_dump
from lammps_scripts import HEADER

TYPES = "angle/types 2 dihedral/types 1"
LOW, LENGTH = np.array([-3.0, -4.0, -1.0]), np.array([8.0, 6.0, 5.0])
REGION = "region box block -3 5 -4 2 -1 4\n"
BOX = REGION + "create_box 2 box " + TYPES + "\nmass * 1.0\n"
OUTPUT = """pair_style none
angle_style zero
angle_coeff *
dihedral_style zero
dihedral_coeff *
comm_modify cutoff 2.0
compute angles all property/local aatom1 aatom2 aatom3 atype
dump atoms all custom 1 atoms.dump id mol type x y z ix iy iz d2_biem_reference[1] &
  d2_biem_reference[2] d2_biem_reference[3]
dump_modify atoms sort id format float %.17g
dump angles all local 1 angles.dump c_angles[1] c_angles[2] c_angles[3] c_angles[4]
thermo_style custom step atoms angles dihedrals
run 0
print "result $(atoms) $(angles) $(dihedrals)"
"""

# A flat square 0 < x, y < 1 and a closed tetrahedron.
SQUARE = "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n"
TETRAHEDRON = ("OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")


def shortest_image(difference):
    return difference - LENGTH * np.round(difference / LENGTH)


def area_vectors(x, triangles):
    a, b, c = x[triangles[:, 0]], x[triangles[:, 1]], x[triangles[:, 2]]
    return 0.5 * np.cross(shortest_image(b - a), shortest_image(c - a))


def strip_off(n, x_period):
    """A sheet z = 0 from a file that spans the box along x and y, both ends included."""
    nodes = [(x_period * i / n, LENGTH[1] * j / n, 0.0) for j in range(n + 1)
             for i in range(n + 1)]
    faces = []
    for j in range(n):
        for i in range(n):
            k = i + (n + 1) * j
            faces += [(k, k + 1, k + n + 2), (k, k + n + 2, k + n + 1)]
    lines = [f"OFF {len(nodes)} {len(faces)} 0"] + [" ".join(map(repr, p)) for p in nodes]
    return "\n".join(lines + ["3 %d %d %d" % f for f in faces]) + "\n"


class CreateWall(CreateCase):
    command, box, output = "create_wall", BOX, OUTPUT

    def assert_repeats(self, x, angles, shift):
        """The shift takes nodes to nodes and triangles to triangles."""
        apart = shortest_image(x[None] - (x + shift)[:, None])
        image = np.argmin(np.linalg.norm(apart, axis=2), axis=1)
        self.assertLess(np.linalg.norm(apart[np.arange(len(x)), image], axis=1).max(), 1e-12)

        def key(t):
            k = int(np.argmin(t))
            return t[k], t[(k + 1) % 3], t[(k + 2) % 3]
        triangles = {key(t) for t in angles[:, :3] - 1}
        self.assertEqual(triangles, {key(image[t]) for t in angles[:, :3] - 1})

    def assert_in_box_as_stored(self, atoms):
        x = atoms[:, 3:6]
        self.assertTrue(np.all(x >= LOW) and np.all(x < LOW + LENGTH))
        self.assertTrue(np.all(atoms[:, 6:9] == 0), "image flags")
        np.testing.assert_array_equal(atoms[:, 9:12], x)


class Shapes(CreateWall):
    def test_plane(self):
        for c, axis in enumerate("xyz"):
            a, b = (c + 1) % 3, (c + 2) % 3
            text, atoms, angles = self.run_output(
                f"create_wall plane {axis} 1.25 edge 0.6 type 2 angle_type 2 molecule 7 group w\n"
                "variable n equal count(w)\nprint \"in group $(v_n)\"\n")
            n = np.ceil(LENGTH / 0.6 - 1e-9).astype(int)
            self.assertEqual(len(atoms), n[a] * n[b])
            self.assertIn(f"result {len(atoms)} {2 * len(atoms)} 0", text)
            self.assertIn(f"in group {len(atoms)}", text)
            self.assertIn(f"Created wall: plane normal to {axis}", text)
            self.assertIn(f"{len(atoms)} nodes, {2 * len(atoms)} angles", text)
            self.assertIn(f"area {LENGTH[a] * LENGTH[b]:.8g}", text)
            self.assertTrue(np.all(atoms[:, 1] == 7) and np.all(atoms[:, 2] == 2))
            self.assertTrue(np.all(angles[:, 3] == 2))
            self.assert_in_box_as_stored(atoms)
            x = atoms[:, 3:6]
            self.assertTrue(np.all(x[:, c] == 1.25))
            each = np.zeros(3)
            each[c] = 0.5 * LENGTH[a] * LENGTH[b] / len(atoms)
            areas = area_vectors(x, angles[:, :3] - 1)
            np.testing.assert_allclose(areas, np.broadcast_to(each, areas.shape), atol=1e-13)
            self.assert_repeats(x, angles, np.eye(3)[a] * LENGTH[a] / n[a])
            self.assert_repeats(x, angles, np.eye(3)[b] * LENGTH[b] / n[b])
            self.assertEqual(np.bincount(angles[:, 1]).max(), 2)

    def test_duct(self):
        for a, axis in enumerate("xyz"):
            across = [k for k in range(3) if k != a]
            place = {across[0]: LOW[across[0]], across[1]: LOW[across[1]] + 1.5}
            text, atoms, angles = self.run_output(
                f"create_wall duct {place[across[0]]} {place[across[1]]} edge 0.7 axis {axis}\n")
            n = np.ceil(LENGTH / 0.7).astype(int)
            self.assertEqual(len(atoms), n[a] * (n[across[0]] + n[across[1]] - 1))
            self.assertEqual(len(angles), 2 * n[a] * (n[across[0]] + n[across[1]]))
            self.assert_in_box_as_stored(atoms)
            x = atoms[:, 3:6]
            areas = area_vectors(x, angles[:, :3] - 1).sum(axis=0)
            expected = LENGTH[a] * LENGTH.sum() - LENGTH[a]**2
            self.assertAlmostEqual(areas.sum(), expected, places=10)
            self.assertAlmostEqual(areas[a], 0.0, places=12)
            on = {k: np.abs(x[:, k] - place[k]) < 1e-12 for k in across}
            self.assertTrue(np.all(on[across[0]] | on[across[1]]))
            self.assertEqual(np.sum(on[across[0]] & on[across[1]]), n[a])
            self.assert_repeats(x, angles, np.eye(3)[a] * LENGTH[a] / n[a])
            self.assertIn(f"duct along {axis}", text)
            self.assertLessEqual(np.bincount(angles[:, 1]).max(), 3)

    def test_tube(self):
        for a, axis in enumerate("xyz"):
            across = [k for k in range(3) if k != a]
            center = LOW + 0.3    # the tube crosses the faces of the box
            _, atoms, angles = self.run_output(
                f"create_wall tube radius 1.8 center {center[across[0]]} {center[across[1]]} "
                f"edge 0.5 axis {axis}\n")
            n = int(np.ceil(LENGTH[a] / 0.5))
            n_around = int(np.ceil(2 * np.pi * 1.8 / 0.5))
            self.assertEqual(len(atoms), n * n_around)
            self.assertEqual(len(angles), 2 * n * n_around)
            self.assert_in_box_as_stored(atoms)
            x, triangles = atoms[:, 3:6], angles[:, :3] - 1
            arm = shortest_image(x[triangles[:, 0]] - center)
            arm[:, a] = 0.0
            areas = area_vectors(x, triangles)
            self.assertGreater(np.einsum("ij,ij->i", arm, areas).min(), 0.0)
            volume = 0.5 * np.einsum("ij,ij->", arm, areas)
            self.assertAlmostEqual(volume / (np.pi * 1.8**2 * LENGTH[a]), 1.0, places=11)
            self.assert_repeats(x, angles, np.eye(3)[a] * LENGTH[a] / n)

    def test_mesh(self):
        (self.folder / "square.off").write_text(SQUARE)
        text, atoms, angles = self.run_output(
            "create_wall mesh square.off scale 0.5 move 4.75 0.1 -1\n")
        # in one piece across the face of the box
        x = atoms[:, 3:6] + atoms[:, 6:9] * LENGTH
        expected = 0.5 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]) + [4.75, 0.1, -1]
        np.testing.assert_allclose(x, expected, atol=1e-14)
        np.testing.assert_allclose(atoms[:, 9:12], expected, atol=1e-14)
        self.assertEqual(len(angles), 2)
        self.assertIn("the wall ends at 4 open edges", text)
        self.assertIn("area 0.25", text)
        (self.folder / "sheet.off").write_text(strip_off(12, LENGTH[0]))
        text, atoms, angles = self.run_output("create_wall mesh sheet.off move -3 -4 1\n")
        self.assertEqual((len(atoms), len(angles)), (144, 288))
        self.assertNotIn("open edges", text)
        self.assertIn("area 48", text)
        areas = area_vectors(atoms[:, 3:6], angles[:, :3] - 1)
        np.testing.assert_allclose(areas.sum(axis=0), [0, 0, 48], atol=1e-11)


class Together(CreateWall):
    def test_same_on_1_2_and_4_ranks(self):
        (self.folder / "body.off").write_text(TETRAHEDRON)
        commands = ("create_wall duct -4 -1 edge 0.5 group walls\n"
                    "create_wall tube radius 0.8 center -1 1.5 edge 0.3 group walls\n"
                    "create_wall mesh body.off scale 0.7 move 4.6 0.9 3.1 type 2\n"
                    "create_cells sphere radius 0.5 nodes 42 random 12 3 gap 0.05\n")
        results = []
        for n_ranks in (1, 2, 4):
            _, atoms, angles = self.run_output(commands, n_ranks)
            results.append((atoms, angles[np.lexsort(angles.T)]))
        self.assertEqual(results[0][0][-1, 1], 15)
        self.assertEqual([np.sum(results[0][0][:, 1] == m) for m in (1, 2, 3)],
                         [16 * 21, 27 * 17, 4])
        for atoms, angles in results[1:]:
            np.testing.assert_array_equal(atoms, results[0][0])
            np.testing.assert_array_equal(angles, results[0][1])

    def test_cells_and_bodies_after_walls_without_extra_words(self):
        text, atoms, _ = self.run_output(
            "create_wall plane z -1 edge 0.5\n"
            "create_cells rbc nodes 162 random 8 5 gap 0.03\n")
        self.assertIn("Created 8 cells", text)
        cells = (atoms[:, 3:6] + atoms[:, 6:9] * LENGTH)[atoms[:, 1] > 1].reshape(8, 162, 3)
        for cell in cells:    # between the sheet and its next image, whichever
            heights = cell[:, 2] + 1.0
            heights -= 5.0 * np.floor(heights.mean() / 5.0)
            self.assertGreater(heights.min(), 0.03)
            self.assertLess(heights.max(), 4.97)

    def test_walls_beside_membranes_have_no_elasticity(self):
        done = self.run_lammps(
            HEADER + BOX + "create_wall duct -4 -1 edge 0.6 type 2 angle_type 2\n"
            "create_cells rbc nodes 162 random 2 3\npair_style none\n"
            "angle_style hybrid biem/skalak zero\nangle_coeff 1 biem/skalak 1.0 100.0\n"
            "angle_coeff 2 zero\ndihedral_style biem/bend\ndihedral_coeff * 0.0033 sphere\n"
            "comm_modify cutoff 2.0\ndump f all custom 1 forces.dump type fx fy fz\nrun 0\n"
            "print \"energy $(eangle:%.15g)\"\n", n_ranks=2)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-1000:])
        self.assertLess(abs(float(done.stdout.split("energy")[-1].split()[0])), 1e-18)
        forces = read_dump(self.folder / "forces.dump")
        self.assertTrue(np.all(forces[forces[:, 0] == 2, 1:] == 0.0))
        self.assertGreater(np.abs(forces[forces[:, 0] == 1, 1:]).max(), 0.0)

    def test_survives_restart(self):
        first = self.run_lammps(HEADER + BOX + "create_wall duct 0 0 edge 0.7\n" + OUTPUT +
                                "write_restart wall.restart\n")
        self.assertEqual(first.returncode, 0, first.stdout[-2000:])
        before = read_dump(self.folder / "atoms.dump")
        again = self.run_lammps("read_restart wall.restart\nfix biem_reference all property/atom "
                                "d2_biem_reference 3 ghost yes\n" + OUTPUT)
        self.assertEqual(again.returncode, 0, again.stdout[-2000:] + again.stderr)
        np.testing.assert_array_equal(read_dump(self.folder / "atoms.dump"), before)


class BadInput(CreateWall):
    def test_arguments(self):
        (self.folder / "square.off").write_text(SQUARE)
        (self.folder / "quad.off").write_text("OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
        for arguments, message in (
                ("", "ends too early"),
                ("sphere radius 1", "unknown shape 'sphere'"),
                ("plane w 0 edge 1", "unknown axis 'w'"),
                ("plane z 0", "keyword edge is missing"),
                ("plane z 0 edge 0", "must be a positive number"),
                ("plane z 0 edge 1 edge 1", "is given twice"),
                ("plane z 0 edge 1 colour red", "unknown keyword 'colour'"),
                ("plane z 0 edge 1 axis x", "axis does not belong to plane"),
                ("plane z 0 edge 1 radius 1", "radius does not belong to plane"),
                ("plane z 0 edge 1 scale 2", "scale does not belong to plane"),
                ("plane z 4.5 edge 1", "z = 4.5 lies outside the box, which goes from -1 to 4"),
                ("plane z 0 edge 3.1", "must be less than 3, half the length of the box along y"),
                ("plane z 0 edge 1 type 3", "atom type 3 does not exist"),
                ("plane z 0 edge 1 angle_type 3", "angle type 3 does not exist"),
                ("plane z 0 edge 1 molecule 0", "must be 1 or more"),
                ("duct 0", "ends too early"),
                ("duct 0 7 edge 1", "z = 7 lies outside the box"),
                ("duct 3 0 edge 1", "y = 3 lies outside the box"),
                ("duct 3 3 edge 1 axis y", "ok"),
                ("tube radius 1 edge 0.5", "tube needs radius and center"),
                ("tube radius 1 center 0 0 edge 1.5", "exceeds the radius"),
                ("tube radius 2.5 center 0 0 edge 0.5", "must not touch its own periodic images"),
                ("mesh", "ends too early"),
                ("mesh square.off edge 1", "edge does not belong to mesh"),
                ("mesh square.off scale 5", "half the shortest height of the box"),
                ("mesh none.stl", "Mesh file none.stl: cannot be opened"),
                ("mesh quad.off", "line 6: a face of 4 corners")):
            if message == "ok":
                done = self.run_lammps(HEADER + BOX + f"create_wall {arguments}\n")
                self.assertEqual(done.returncode, 0, done.stdout[-2000:])
            else:
                self.assert_refused(f"create_wall {arguments}\n", message)

    def test_errors_of_the_file_reach_all_ranks(self):
        self.assert_refused("create_wall mesh none.off\n", "cannot be opened", n_ranks=2)

    def test_what_is_in_the_way(self):
        cell = "create_cells rbc nodes 162 single 0 0 1\n"
        room = BOX.replace(TYPES, TYPES + " extra/angle/per/atom 3 extra/dihedral/per/atom 3")
        self.assert_refused(cell + "create_wall plane z 1.05 edge 0.5\n", "it crosses a surface",
                            n_ranks=2)
        self.assert_refused("create_atoms 1 single 0 0 1\ncreate_wall plane z 1 edge 0.5\n",
                            "an existing atom lies on it", box=room)
        self.assert_refused("create_wall plane z 1 edge 0.5\ncreate_wall plane y 0.03 edge 0.45\n",
                            "must be one duct")
        wall = "create_wall plane z 1 edge 0.5\n"
        done = self.run_lammps(HEADER + BOX + wall + cell.replace("0 0 1", "0 0 1.2"))
        self.assertIn("create_cells: Placement: the red cell of equivalent radius 1 does not keep",
                      " ".join(done.stdout.split()))

    def test_molecule_in_use(self):
        self.assert_refused("create_wall plane z 1 edge 0.5\n"
                            "create_wall plane z 2 edge 0.5 molecule 1\n",
                            "molecule 1 exists already; the next free molecule ID is 2")

    def test_no_room_for_angles(self):
        self.assert_refused("create_atoms 1 single 4 0.1 0.1\ncreate_wall duct 0 0 edge 0.5\n",
                            "extra/angle/per/atom 3 extra/dihedral/per/atom 3")

    def test_system(self):
        wall = "create_wall plane z 0 edge 0.5\n"
        self.assert_refused(wall, "no box yet", box="")
        self.assert_refused(wall, "newton is off", header=HEADER.replace("newton on", "newton off"))
        self.assert_refused(wall, "must be three-dimensional and periodic",
                            header=HEADER.replace("p p p", "p p f"))
        self.assert_refused(wall, "the box is tilted", box=BOX.replace(
            "block -3 5 -4 2 -1 4", "prism -3 5 -4 2 -1 4 0 1 0"))


if __name__ == "__main__":
    unittest.main()
