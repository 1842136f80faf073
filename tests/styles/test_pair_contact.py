"""pair_style biem/contact in LAMMPS: energy from the law, forces as its slopes, balance, periodic
images, tilted boxes, ranks, walls, penetration, restarts, rerun, data files, bad input."""

import unittest

import numpy as np

import membrane_cases as cases
from create_cases import read_dump

RANGE, STIFFNESS = 0.1, 10.0

BOX = """region box prism 0 5 0 5 0 5 0 {tilt} 0
create_box 3 box angle/types 1 dihedral/types 1
mass * 1.0
"""
STYLES = """pair_style biem/contact 0.1
pair_coeff * * 10.0
"""
TOPOLOGY = """angle_style zero
angle_coeff *
dihedral_style zero
dihedral_coeff *
neighbor 0.2 bin
comm_modify cutoff 2.0
"""
OUTPUT = """compute c all pair biem/contact
compute p all pressure NULL virial
compute a all pe/atom pair
compute s all stress/atom NULL pair
compute sums all reduce sum c_a c_s[1] c_s[2] c_s[3] c_s[4] c_s[5] c_s[6]
thermo_style custom step pe evdwl vol c_c c_c[1] c_c[2] c_c[3] c_c[4] c_p[1] c_p[2] c_p[3] &
  c_p[4] c_p[5] c_p[6] c_sums[1] c_sums[2] c_sums[3] c_sums[4] c_sums[5] c_sums[6] c_sums[7]
thermo_modify norm no format float %.17g
"""
DUMP = """run 0
write_dump all custom atoms.dump id mol type xu yu zu fx fy fz modify sort id format float %.17g
compute corners all property/local aatom1 aatom2 aatom3
dump angles all local 1 angles.dump c_corners[1] c_corners[2] c_corners[3]
run 0
"""

# Scenes: the surfaces, apart from each other, then the shift of molecule 2 that brings it near.
# Two spheres across the faces x = 0 and y = 0.
CELLS = ("create_cells sphere radius 1 nodes 162 single 0.05 0.1 2.5\n"
         "create_cells sphere radius 1 nodes 162 single 2.6 0.3 2.4 orientation 1 2 3 type 2\n",
         (-0.56, -0.17, 0.08))
# A cell above a periodic sheet, which does not act.
WALL = ("create_wall plane z 1.0 edge 0.5 molecule 1\n"
        "create_cells sphere radius 1 nodes 162 single 4.9 2.5 2.3 molecule 2 type 2\n",
        (0.0, 0.0, -0.27))
# A platelet with its edge in the dimple of a red cell.
PLATELET = ("create_cells rbc nodes 642 single 2.5 2.5 2.5\n"
            "create_cells platelet diameter 0.993 thickness 0.248 nodes 162 single 2.6 2.45 3.6 "
            "orientation 1 0.3 0.1 type 3\n", (0.0, 0.0, -0.37))


def closest_points(p, a, b, c):
    """Of the triangles with corners a, b, c (n x 3): the points nearest to p."""
    best = np.full(len(a), np.inf)
    result = np.zeros_like(a)

    def take(points, valid):
        distance = np.where(valid, np.linalg.norm(p - points, axis=1), np.inf)
        nearer = distance < best
        best[nearer], result[nearer] = distance[nearer], points[nearer]

    for u, v in ((a, b), (b, c), (c, a)):
        t = np.clip(np.sum((p - u) * (v - u), axis=1) / np.sum((v - u) ** 2, axis=1), 0.0, 1.0)
        take(u + t[:, None] * (v - u), True)
    normal = np.cross(b - a, c - a)
    foot = p - normal * (np.sum((p - a) * normal, axis=1) / np.sum(normal ** 2, axis=1))[:, None]
    inside = np.ones(len(a), bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= np.sum(np.cross(v - u, foot - u) * normal, axis=1) >= 0.0
    take(foot, inside)
    return result


def is_inside(p, a, b, c):
    """Whether the solid angles of the triangles add up to 4 pi."""
    u, v, w = a - p, b - p, c - p
    lengths = [np.linalg.norm(x, axis=1) for x in (u, v, w)]
    numerator = np.sum(u * np.cross(v, w), axis=1)
    denominator = (lengths[0] * lengths[1] * lengths[2] + np.sum(u * v, axis=1) * lengths[2] +
                   np.sum(v * w, axis=1) * lengths[0] + np.sum(w * u, axis=1) * lengths[1])
    return np.sum(2.0 * np.arctan2(numerator, denominator)) > 2.0 * np.pi


def energy_density(s):
    """k delta [ln(delta/s) - (1 - s/delta)], parabola below 0.02 delta."""
    d = max(s, 0.02 * RANGE)
    pressure = STIFFNESS * (RANGE / d - 1.0)
    energy = STIFFNESS * (RANGE * np.log(RANGE / d) - (RANGE - d))
    return energy + pressure * (d - s) + 0.5 * STIFFNESS * RANGE / d ** 2 * (d - s) ** 2


class ContactCase(cases.FolderCase):
    def script(self, scene, shift=None, tilt=0.0, styles=STYLES, more=""):
        commands, usual = scene
        shift = usual if shift is None else shift
        return ("units lj\nnewton on\natom_style molecular\natom_modify map yes\n"
                "boundary p p p\n" + BOX.format(tilt=tilt) + commands + styles + TOPOLOGY +
                "group moved molecule 2\ndisplace_atoms moved move " +
                " ".join(map(repr, shift)) + " units box\n" + OUTPUT + more)

    def solve(self, scene, n_ranks=1, **options):
        """Thermo row and atoms: id, molecule, type, position (unwrapped), force."""
        row = cases.run_thermo(self.script(scene, **options) + DUMP, self.folder, n_ranks)[-1]
        return row, read_dump(self.folder / "atoms.dump")

    def wrap(self, difference, tilt=0.0):
        box = np.array([[5.0, 0.0, tilt], [0.0, 5.0, 0.0], [0.0, 0.0, 5.0]])
        return difference - np.round(difference @ np.linalg.inv(box).T) @ box.T

    def compute_energy(self, atoms):
        """Without a neighbor list: every node of the one against all triangles of the other."""
        triangles = read_dump(self.folder / "angles.dump").astype(int) - 1
        x, molecule = atoms[:, 3:6], atoms[:, 1].astype(int)
        energy = 0.0
        for acting, other in ((1, 2), (2, 1)):
            corners = triangles[molecule[triangles[:, 0]] == other]
            area = np.zeros(len(x))
            for t in triangles:
                area[t] += np.linalg.norm(np.cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]])) / 6.0
            for i in np.flatnonzero(molecule == acting):
                p = x[i]
                shift = self.wrap(x[corners[:, 0]] - p) - (x[corners[:, 0]] - p)
                a, b, c = (x[corners[:, k]] + shift for k in range(3))
                d = np.linalg.norm(p - closest_points(p, a, b, c), axis=1).min()
                if d < RANGE:
                    s = -d if is_inside(p, a, b, c) else d
                    energy += 0.5 * area[i] * energy_density(s)
        return energy


class EnergyAndForce(ContactCase):
    def check_slopes(self, scene, h=2e-6, **options):
        row, atoms = self.solve(scene, **options)
        self.assertGreater(row["c_c[1]"], 3)
        force = atoms[:, 6:9]
        chosen = []
        for molecule in (1, 2):
            own = np.flatnonzero(atoms[:, 1] == molecule)
            chosen += list(own[np.argsort(-np.linalg.norm(force[own], axis=1))[:3]])
        moves = ""
        for i in chosen:
            moves += f"group one id {int(atoms[i, 0])}\n"
            for k in range(3):
                for step, run in ((h, "run 0\n"), (-2.0 * h, "run 0\n"), (h, "")):
                    move = ["0"] * 3
                    move[k] = repr(step)
                    moves += f"displace_atoms one move {' '.join(move)} units box\n" + run
            moves += "group one delete\n"
        rows = cases.run_thermo(self.script(scene, more=moves, **options), self.folder)
        energy = np.array([r["PotEng"] for r in rows]).reshape(len(chosen), 3, 2)
        slopes = -(energy[:, :, 0] - energy[:, :, 1]) / (2.0 * h)
        error = np.abs(slopes - force[chosen]).max() / np.abs(force).max()
        self.assertLess(error, 1e-6)

    def test_forces_are_slopes_between_cells(self):
        self.check_slopes(CELLS)

    def test_forces_are_slopes_where_cells_penetrate(self):
        shift = (-0.68, -0.17, 0.08)
        row, _ = self.solve(CELLS, shift=shift)
        self.assertGreater(row["c_c[4]"], 3)
        self.check_slopes(CELLS, shift=shift)

    def test_forces_are_slopes_at_walls(self):
        self.check_slopes(WALL)

    def test_forces_are_slopes_between_cell_and_platelet(self):
        self.check_slopes(PLATELET)

    def test_energy_is_that_of_all_nodes_and_triangles(self):
        for scene, shift in ((CELLS, None), (CELLS, (-0.68, -0.17, 0.08)), (PLATELET, None)):
            row, atoms = self.solve(scene, shift=shift)
            self.assertAlmostEqual(row["PotEng"] / self.compute_energy(atoms), 1.0, delta=1e-10)
            self.assertEqual(row["PotEng"], row["E_vdwl"])
            self.assertEqual(row["PotEng"], row["c_c"])

    def test_force_and_torque_balance_and_virial(self):
        for scene in (CELLS, WALL, PLATELET):
            row, atoms = self.solve(scene)
            force = atoms[:, 6:9]
            largest = np.abs(force).max()
            self.assertGreater(largest, 1e-3)
            self.assertLess(np.abs(force.sum(axis=0)).max(), 1e-13 * len(force) * largest)
            if scene is WALL:
                continue    # its atoms are on both sides of the box
            # the unwrapped bodies are near each other but for a multiple of the box
            x = atoms[:, 3:6].copy()
            first, second = atoms[:, 1] == 1, atoms[:, 1] == 2
            difference = x[second].mean(axis=0) - x[first].mean(axis=0)
            x[second] += self.wrap(difference) - difference
            torque = np.cross(x, force).sum(axis=0)
            self.assertLess(np.abs(torque).max(), 1e-12 * len(force) * largest)
            virial = [np.sum(x[:, a] * force[:, b])
                      for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
            scale = np.abs(virial).max()
            for k in range(6):
                self.assertAlmostEqual(row[f"c_p[{k + 1}]"] * row["Volume"], virial[k],
                                       delta=1e-10 * scale)
                self.assertAlmostEqual(-row[f"c_sums[{k + 2}]"], virial[k], delta=1e-10 * scale)
            self.assertAlmostEqual(row["c_sums[1]"], row["PotEng"], delta=1e-12 * row["PotEng"])

    def test_no_contact(self):
        for scene in (CELLS, WALL, PLATELET):
            row, atoms = self.solve(scene, shift=(0.0, 0.0, 0.0))
            self.assertEqual(row["PotEng"], 0.0)
            self.assertEqual([row[f"c_c[{k}]"] for k in (1, 2, 3, 4)], [0.0, RANGE, 0.0, 0.0])
            self.assertEqual(np.abs(atoms[:, 6:9]).max(), 0.0)


class Walls(ContactCase):
    def test_cells_are_pushed_off_both_sides(self):
        for height, sign in ((2.3, 1.0), (-0.3, -1.0)):
            scene = (WALL[0].replace("4.9 2.5 2.3", f"4.9 2.5 {height}"), None)
            for gap in (0.05, -0.05):    # penetrated: pushed back to where its center is
                row, atoms = self.solve(scene, shift=(0.0, 0.0, -sign * (0.3 - gap)))
                cell = atoms[:, 1] == 2
                self.assertGreater(sign * atoms[cell, 8].sum(), 0.0)
                self.assertAlmostEqual(row["c_c[2]"], gap, delta=0.012)
                self.assertEqual(row["c_c[4]"] > 0, gap < 0.0)

    def test_walls_do_not_act(self):
        row, atoms = self.solve(WALL)
        acting = np.flatnonzero((np.abs(atoms[:, 8]) > 0.0) & (atoms[:, 1] == 2))
        self.assertEqual(row["c_c[1]"], len(acting))

    def test_a_closed_surface_can_be_named_a_wall(self):
        free, _ = self.solve(CELLS)
        named, _ = self.solve(CELLS, styles="group fixed molecule 1\npair_style biem/contact 0.1 "
                              "walls fixed\npair_coeff * * 10.0\n")
        self.assertNotEqual(named["c_c[1]"], free["c_c[1]"])
        self.assertGreater(named["c_c[1]"], 0)


class Distribution(ContactCase):
    def test_ranks_images_and_tilts(self):
        for scene in (CELLS, WALL, PLATELET):
            for tilt in (0.0,) if scene is WALL else (0.0, 2.4):
                first_row, first = self.solve(scene, tilt=tilt)
                self.assertGreater(first_row["c_c[1]"], 3)
                force = first[:, 6:9]
                for n_ranks in (2, 4):
                    row, atoms = self.solve(scene, n_ranks, tilt=tilt)
                    error = np.abs(atoms[:, 6:9] - force).max() / np.abs(force).max()
                    self.assertLess(error, 1e-12)
                    for name in first_row:
                        self.assertAlmostEqual(row[name], first_row[name],
                                               delta=1e-12 * max(1.0, abs(first_row[name])))

    def test_position_in_the_box_does_not_matter(self):
        row, atoms = self.solve(CELLS)
        moved, other = self.solve(CELLS, more="displace_atoms all move 1.3 2.1 2.7 units box\n")
        self.assertAlmostEqual(moved["PotEng"], row["PotEng"], delta=1e-11 * row["PotEng"])
        error = np.abs(atoms[:, 6:9] - other[:, 6:9]).max()
        self.assertLess(error, 1e-11 * np.abs(atoms[:, 6:9]).max())

    def test_tiled_ranks(self):
        _, atoms = self.solve(CELLS)
        _, other = self.solve(CELLS, 4, more="comm_style tiled\nbalance 1.0 rcb\n")
        error = np.abs(atoms[:, 6:9] - other[:, 6:9]).max()
        self.assertLess(error, 1e-12 * np.abs(atoms[:, 6:9]).max())


class Coefficients(ContactCase):
    def test_pairs_of_types(self):
        none = STYLES.replace("* * 10.0", "* * 0.0")
        self.assertEqual(self.solve(CELLS, styles=none)[0]["PotEng"], 0.0)
        half = self.solve(CELLS, styles=none + "pair_coeff 1 2 5.0\n")[0]["PotEng"]
        self.assertAlmostEqual(2.0 * half, self.solve(CELLS)[0]["PotEng"], delta=1e-12)

    def test_hybrid(self):
        alone = self.solve(CELLS)[0]["PotEng"]
        for style in ("hybrid", "hybrid/overlay"):
            styles = (f"pair_style {style} zero 1.0 biem/contact 0.1\npair_coeff * * zero\n"
                      "pair_coeff 1 2 biem/contact 10.0\n")
            self.assertAlmostEqual(self.solve(CELLS, styles=styles)[0]["PotEng"], alone,
                                   delta=1e-13 * alone)

    def test_restart_keeps_them(self):
        first = cases.run_thermo(self.script(CELLS) + "run 0\nwrite_restart two.restart\n",
                                 self.folder)[-1]
        again = cases.run_thermo("read_restart two.restart\n" + TOPOLOGY + OUTPUT + "run 0\n",
                                 self.folder, 2)[-1]
        self.assertAlmostEqual(again["PotEng"], first["PotEng"], delta=1e-13 * first["PotEng"])

    def test_rerun_gives_the_same_energy(self):
        dump = "dump d all custom 1 two.dump id x y z\ndump_modify d format float %.17g\n"
        rows = cases.run_thermo(self.script(CELLS, more=dump) + "run 0\nundump d\n"
                                "rerun two.dump dump x y z\n", self.folder)
        self.assertEqual(len(rows), 2)
        self.assertGreater(rows[0]["PotEng"], 0.0)
        self.assertAlmostEqual(rows[1]["PotEng"], rows[0]["PotEng"],
                               delta=1e-10 * rows[0]["PotEng"])

    def test_data_file_keeps_them(self):
        styles = STYLES + "pair_coeff 1 2 7.0\n"
        first = cases.run_thermo(self.script(CELLS, styles=styles) +
                                 "run 0\nwrite_data two.data pair ij\n", self.folder)[-1]
        again = cases.run_thermo(
            "units lj\nnewton on\natom_style molecular\natom_modify map yes\n"
            "pair_style biem/contact 0.1\nangle_style zero\ndihedral_style zero\n"
            "fix biem_reference all property/atom d2_biem_reference 3 ghost yes\n"
            "read_data two.data fix biem_reference NULL biem_reference\n"
            "comm_modify cutoff 2.0\n" + OUTPUT + "run 0\n", self.folder)[-1]
        self.assertAlmostEqual(again["PotEng"], first["PotEng"], delta=1e-4 * first["PotEng"])


class BadInput(ContactCase):
    def test_commands(self):
        for styles, parts in (
                ("pair_style biem/contact\n", ("range delta",)),
                ("pair_style biem/contact 0.0\n", ("delta is 0", "positive")),
                ("pair_style biem/contact 0.1 walls none\npair_coeff * * 1\n",
                 ("group none", "does not exist")),
                ("pair_style biem/contact 0.1\npair_coeff * * -1.0\n", ("k is -1", "positive")),
                ("pair_style biem/contact 0.1\npair_coeff * *\n", ("two atom types and k",)),
                ("pair_style biem/contact 0.1\npair_coeff 3 1 1.0\n", ("sets nothing",)),
                ("pair_style biem/contact 0.1\npair_coeff 1 1 1.0\n",
                 ("no pair_coeff for atom types|All pair coeffs are not set",))):
            with self.subTest(styles=styles):
                self.expect_error(self.script(CELLS, styles=styles) + "run 0\n", *parts)

    def test_triangle_that_has_grown(self):
        # one node flies away within a run: its edges become too long for the neighbor list
        more = ("group one id 5\nvelocity all set 0 0 0\nvelocity one set 300 0 0\n"
                "fix move one nve\ntimestep 0.001\nneigh_modify every 1 delay 0 check yes\nrun 5\n")
        self.expect_error(self.script(CELLS, shift=(0.0, 0.0, 0.0), more=more), "molecule 1",
                          "beyond the limit", "start a new run")


if __name__ == "__main__":
    unittest.main()
