"""angle_style biem/skalak and dihedral_style biem/bend in LAMMPS: energies, forces, virial,
periodic images, ranks, restart and data files, and the messages for bad input."""

import unittest

import numpy as np

import membrane_cases as cases

PRESSURE = "compute p all pressure NULL virial\ncompute f all reduce sum fx fy fz\n"
COLUMNS = "eangle edihed vol c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6] c_f[1] c_f[2] c_f[3]"


def make_cell(center):
    """A sphere stretched and bent, with the sphere as its reference."""
    reference, _ = cases.make_icosphere()
    positions = reference * [1.2, 0.9, 0.7]
    positions[:, 2] += 0.1 * positions[:, 0] ** 2
    return positions + np.asarray(center), reference


def compute_skalak_energy(positions, reference, shear, dilatation):
    """Eq. 7 by singular values of the deformation gradient, triangle by triangle."""
    _, triangles = cases.make_icosphere()
    energy = 0.0
    for t in triangles:
        def in_plane(x):
            edges = np.array([x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]]).T
            return np.linalg.qr(edges)[1]
        ref = in_plane(reference)
        stretches = np.linalg.svd(in_plane(positions) @ np.linalg.inv(ref), compute_uv=False)
        i1, i2 = np.sum(stretches ** 2) - 2.0, np.prod(stretches) ** 2 - 1.0
        energy += 0.5 * abs(np.linalg.det(ref)) * (
            shear / 2 * (i1 ** 2 / 2 + i1 - i2) + dilatation / 8 * i2 ** 2)
    return energy


def compute_bending_energy(positions, modulus):
    _, triangles = cases.make_icosphere()
    beta0 = np.sqrt(16.0 * np.pi / (3.0 * np.sqrt(3.0) * len(triangles)))
    energy = 0.0
    for a, b, c, d in cases.make_hinges(triangles):
        n1 = np.cross(positions[b] - positions[a], positions[c] - positions[a])
        n2 = np.cross(positions[c] - positions[d], positions[b] - positions[d])
        edge = positions[c] - positions[b]
        beta = np.arctan2(np.cross(n1, n2) @ edge / np.linalg.norm(edge), n1 @ n2)
        energy += 2.0 / np.sqrt(3.0) * modulus * (1.0 - np.cos(beta - beta0))
    return energy


class MembraneCase(cases.FolderCase):
    def write(self, *centers, **options):
        cases.write_data(self.data, [make_cell(c) for c in centers], **options)

    def script(self, extra="", styles=cases.STYLES, header=cases.HEADER, columns=COLUMNS):
        return (header + cases.READ.format(data=self.data) + styles + PRESSURE + extra +
                cases.THERMO.format(columns=columns))


class EnergyAndForce(MembraneCase):
    def test_energies_are_those_of_the_equations(self):
        self.write((2, 2, 2))
        row = cases.run_thermo(self.script(), self.folder)[-1]
        positions, reference = make_cell((0, 0, 0))
        self.assertAlmostEqual(row["E_angle"] / compute_skalak_energy(positions, reference, 1, 20),
                               1.0, delta=1e-12)
        self.assertAlmostEqual(row["E_dihed"] / compute_bending_energy(positions, 0.05), 1.0,
                               delta=1e-12)
        self.assertAlmostEqual(row["PotEng"], row["E_angle"] + row["E_dihed"], delta=1e-12)

    def test_periodic_images_tilts_and_ranks_give_the_same_numbers(self):
        rows = []
        for center in ((2, 2, 2), (0.1, 3.9, 4.05)):
            for tilt in (None, (0.0, 2.0, 0.0), (0.0, -2.0, 0.0)):
                self.write(center, tilt=tilt)
                for n_ranks in (1, 2, 4):
                    rows.append(cases.run_thermo(self.script(), self.folder, n_ranks)[-1])
        first = rows[0]
        for row in rows[1:]:
            for name in first:
                scale = abs(first["PotEng"])
                self.assertAlmostEqual(row[name], first[name], delta=1e-12 * scale, msg=name)

    def test_total_force_is_zero_and_virial_symmetric_and_exact(self):
        self.write((0.1, 3.9, 4.05))
        extra = "compute c all biem/cell\n"
        stresslet = " ".join(f"c_c[1][{k}]" for k in range(17, 23))
        row = cases.run_thermo(self.script(extra, columns=COLUMNS + " " + stresslet),
                               self.folder)[-1]
        for k in range(1, 4):
            self.assertAlmostEqual(row[f"c_f[{k}]"], 0.0, delta=1e-12)
        for k in range(6):    # sum F x, once from the pair-wise tally, once from positions
            self.assertAlmostEqual(row[f"c_p[{k + 1}]"] * row["Volume"], -row[f"c_c[1][{17 + k}]"],
                                   delta=1e-12 * abs(row["PotEng"]))

    def test_forces_are_the_slopes_of_the_energy(self):
        self.write((0.1, 3.9, 4.05))
        h, atom = 2e-4, 17
        script = self.script("variable fx equal fx[17]\nvariable fy equal fy[17]\n"
                             "variable fz equal fz[17]\ngroup moved id 17\n",
                             columns="v_fx v_fy v_fz")
        for k in range(3):
            position = 0.0
            for target in (h, -h, h / 2, -h / 2, 0.0):
                step = ["0", "0", "0"]
                step[k] = repr(target - position)
                position = target
                script += f"displace_atoms moved move {' '.join(step)} units box\nrun 0\n"
        rows = cases.run_thermo(script, self.folder)
        force = [rows[0][f"v_f{c}"] for c in "xyz"]
        for k in range(3):
            energy = [row["PotEng"] for row in rows[1 + 5 * k:5 + 5 * k]]
            coarse, fine = (energy[0] - energy[1]) / (2 * h), (energy[2] - energy[3]) / h
            slope = (4 * fine - coarse) / 3
            self.assertAlmostEqual(-slope, force[k], delta=1e-7 * np.linalg.norm(force))

    def test_sphere_angle_is_counted_per_molecule_and_equals_the_value(self):
        self.write((1.1, 2, 2), (3.1, 2, 4.05))
        beta0 = np.degrees(np.sqrt(16.0 * np.pi / (3.0 * np.sqrt(3.0) * 320)))
        by_value = cases.STYLES.replace("sphere", f"{beta0:.17g}")
        for n_ranks in (1, 4):
            one = cases.run_thermo(self.script(), self.folder, n_ranks)[-1]
            other = cases.run_thermo(self.script(styles=by_value), self.folder, n_ranks)[-1]
            self.assertAlmostEqual(one["E_dihed"] / other["E_dihed"], 1.0, delta=1e-12)

    def test_hybrid_styles(self):
        self.write((0.1, 3.9, 4.05))
        hybrid = (cases.STYLES.replace("angle_style biem/skalak", "angle_style hybrid biem/skalak")
                  .replace("angle_coeff *", "angle_coeff * biem/skalak"))
        one = cases.run_thermo(self.script(), self.folder)[-1]
        other = cases.run_thermo(self.script(styles=hybrid), self.folder)[-1]
        self.assertEqual(one, other)


class Files(MembraneCase):
    def test_restart_brings_back_reference_and_coefficients_on_any_rank_count(self):
        self.write((0.1, 3.9, 4.05), (2.2, 1.9, 2.0))
        first = cases.run_thermo(self.script() + "write_restart cells.restart\n", self.folder)[-1]
        script = ("neighbor 0.3 bin\ncomm_modify cutoff 1.5\n"
                  "read_restart cells.restart\npair_style zero 1.0\npair_coeff * *\n" + PRESSURE +
                  cases.THERMO.format(columns=COLUMNS))
        for n_ranks in (1, 2, 4):
            row = cases.run_thermo(script, self.folder, n_ranks)[-1]
            for name in first:
                self.assertAlmostEqual(row[name], first[name], delta=1e-12 * abs(first["PotEng"]))

    def test_restart_of_a_restart(self):
        self.write((0.1, 3.9, 4.05))
        first = cases.run_thermo(self.script() + "write_restart cells.0\n", self.folder)[-1]
        for k in range(2):
            script = (f"read_restart cells.{k}\nneighbor 0.3 bin\ncomm_modify cutoff 1.5\n"
                      "pair_style zero 1.0\npair_coeff * *\n" + PRESSURE +
                      cases.THERMO.format(columns=COLUMNS) + f"write_restart cells.{k + 1}\n")
            row = cases.run_thermo(script, self.folder)[-1]
            self.assertEqual(row["PotEng"], first["PotEng"])

    def test_data_file_brings_back_reference_and_coefficients(self):
        self.write((0.1, 3.9, 4.05))
        first = cases.run_thermo(self.script() + "write_data out.data\n", self.folder)[-1]
        script = (cases.HEADER + "pair_style zero 1.0\nangle_style biem/skalak\n"
                  "dihedral_style biem/bend\n" + cases.READ.format(data="out.data") + PRESSURE +
                  cases.THERMO.format(columns=COLUMNS))
        row = cases.run_thermo(script, self.folder)[-1]
        for name in first:
            self.assertAlmostEqual(row[name], first[name], delta=1e-5 * abs(first["PotEng"]))


class BadInput(MembraneCase):
    def test_coefficients(self):
        self.write((2, 2, 2))
        for old, new, parts in (
                ("1.0 20.0", "0.0 20.0", ("ES is 0", "positive")),
                ("1.0 20.0", "-2 20.0", ("ES is -2", "positive")),
                ("1.0 20.0", "1.0 -3", ("ED is -3", "zero or positive")),
                ("1.0 20.0", "1.0", ("ES and ED",)),
                ("0.05 sphere", "-0.05 sphere", ("EB is -0.05", "zero or positive")),
                ("0.05 sphere", "0.05 300.0", ("beta0", "between")),
                ("0.05 sphere", "0.05", ("'sphere' or beta0",))):
            with self.subTest(new=new):
                self.expect_error(self.script(styles=cases.STYLES.replace(old, new)), *parts)

    def test_newton_off(self):
        self.write((2, 2, 2))
        header = cases.HEADER.replace("newton on", "newton off")
        self.expect_error(self.script(header=header), "newton on")

    def test_no_reference(self):
        self.write((2, 2, 2), with_reference=False)
        read = f"read_data {self.data}\n"
        tail = cases.STYLES + cases.THERMO.format(columns="")
        self.expect_error(cases.HEADER + read + tail, "d2_biem_reference", "missing or all zero",
                          "create_cells", "ghost yes")
        fix = "fix biem_reference all property/atom d2_biem_reference 3 ghost yes\n"
        self.expect_error(cases.HEADER + fix + read + tail, "missing or all zero")

    def test_reference_without_ghosts_or_with_wrong_columns(self):
        self.write((2, 2, 2))
        self.expect_error(self.script().replace(" ghost yes", ""), "ghost yes")
        self.write((2, 2, 2), with_reference=False)
        wrong = (cases.HEADER + "fix biem_reference all property/atom d_biem_reference ghost yes\n"
                 f"read_data {self.data}\n" + cases.STYLES + cases.THERMO.format(columns=""))
        self.expect_error(wrong, "3 columns")

    def test_reference_of_one_cell_zero(self):
        positions, reference = make_cell((1.1, 2, 2))
        other, _ = make_cell((3.1, 2, 2))
        cases.write_data(self.data, [(positions, reference), (other, 0.0 * reference)])
        self.expect_error(self.script(), "reference triangle has no area", "molecule 2")

    def test_collapsed_triangle_and_nan(self):
        positions, reference = make_cell((2, 2, 2))
        _, triangles = cases.make_icosphere()
        a, b, c = triangles[40]
        positions[c] = 0.5 * (positions[a] + positions[b])
        cases.write_data(self.data, [(positions, reference)])
        self.expect_error(self.script(), "collapsed", str(c + 1), "molecule 1", "step 0")

    def test_sphere_without_triangles(self):
        self.write((2, 2, 2))
        script = self.script("set group all mol 0\n")
        self.expect_error(script, "molecule ID 0", "without triangles")


if __name__ == "__main__":
    unittest.main()
