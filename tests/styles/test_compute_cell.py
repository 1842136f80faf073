"""compute biem/cell in LAMMPS: geometry, velocity, energies and stresslet of cells that cross
boundaries, on several ranks, in a sheared box, and the messages for bad input."""

import unittest

import numpy as np

import membrane_cases as cases

N_COLUMNS = 23
COMPUTE = "compute c all biem/cell\n"


def columns_of(molecule):
    return " ".join(f"c_c[{molecule}][{k + 1}]" for k in range(N_COLUMNS))


def row_of(thermo, molecule):
    return np.array([thermo[f"c_c[{molecule}][{k + 1}]"] for k in range(N_COLUMNS)])


def make_cell(center, axes, angle=0.0):
    """Ellipsoid with its first axis turned from x toward z by the angle in degrees."""
    reference, _ = cases.make_icosphere()
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    return reference * axes @ turn.T + np.asarray(center), reference


def compute_volume_and_area(positions):
    _, triangles = cases.make_icosphere()
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return np.sum(a * np.cross(b, c)) / 6.0, np.sum(np.linalg.norm(normals, axis=1)) / 2.0


def compute_mean_over_surface(positions, values):
    """Exact surface mean of values that are linear on each triangle."""
    _, triangles = cases.make_icosphere()
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
    return areas @ values[triangles].mean(axis=1) / areas.sum()


class CellCase(cases.FolderCase):
    def write(self, *made, **options):
        cases.write_data(self.data, list(made), **options)

    def script(self, extra=COMPUTE, columns=None, styles=cases.STYLES, run=True):
        thermo = cases.THERMO.format(columns=columns_of(1) if columns is None else columns)
        return (cases.HEADER + cases.READ.format(data=self.data) + styles + extra +
                (thermo if run else ""))

    def row(self, n_ranks=1, **options):
        return row_of(cases.run_thermo(self.script(**options), self.folder, n_ranks)[-1], 1)


class Geometry(CellCase):
    def test_ellipsoid(self):
        axes, angle, center = (1.3, 1.1, 0.6), 25.0, (2.1, 1.9, 2.2)
        positions, reference = make_cell(center, axes, angle)
        self.write((positions, reference))
        row = self.row()
        volume, area = compute_volume_and_area(positions)
        self.assertAlmostEqual(row[0], volume, delta=1e-12)
        self.assertAlmostEqual(row[1], area, delta=1e-12)
        np.testing.assert_allclose(row[2:5], center, atol=1e-12)
        self.assertAlmostEqual(row[5], angle, delta=1e-9)
        self.assertAlmostEqual(row[6], angle, delta=1e-6)
        self.assertAlmostEqual(row[7], (1.3 - 0.6) / (1.3 + 0.6), delta=1e-12)
        # the polyhedron is smaller than the ellipsoid, in the same ratio for all axes
        np.testing.assert_allclose(row[8:11] / axes, row[8] / axes[0], rtol=1e-12)
        self.assertTrue(0.95 < row[8] / axes[0] < 1.0)
        self.assertAlmostEqual(row[22], angle, delta=1e-9)

    def test_images_tilts_and_ranks_give_the_same_rows(self):
        first = None
        for center in ((2, 2, 2), (0.05, 3.97, 4.02)):
            for tilt in (None, (0.0, 2.0, 0.0), (0.0, -2.0, 0.0)):
                self.write(make_cell(center, (1.3, 1.1, 0.6), 25.0), tilt=tilt)
                for n_ranks in (1, 2, 4):
                    row = self.row(n_ranks)
                    row[2:5] -= center
                    first = row if first is None else first
                    np.testing.assert_allclose(row, first, rtol=1e-12, atol=1e-11)

    def test_cell_longer_than_the_box(self):
        cell = make_cell((3.0, 2, 2), (2.6, 1.1, 0.6), 10.0)
        self.write(cell)
        for n_ranks in (1, 4):
            row = self.row(n_ranks)
            self.assertAlmostEqual(row[0], compute_volume_and_area(cell[0])[0], delta=1e-12)
            self.assertAlmostEqual(row[7], 2.0 / 3.2, delta=1e-12)
            np.testing.assert_allclose(row[2:5], (3.0, 2, 2), atol=1e-12)


class Mechanics(CellCase):
    def test_energies_and_stresslet(self):
        self.write(make_cell((1.1, 2, 0.1), (1.0, 1.0, 1.2)), make_cell((3.1, 2, 2), (0.8, 1, 0.9)))
        columns = "eangle edihed " + columns_of(1) + " " + columns_of(2)
        extra = COMPUTE + "dump d all custom 1 dump.txt id mol fx fy fz\n" \
            "dump_modify d sort id format float %.16g\n"
        for n_ranks in (1, 4):
            thermo = cases.run_thermo(self.script(extra, columns), self.folder, n_ranks)[-1]
            one, two = row_of(thermo, 1), row_of(thermo, 2)
            self.assertAlmostEqual(one[14] + two[14], thermo["E_angle"], delta=1e-12)
            self.assertAlmostEqual(one[15] + two[15], thermo["E_dihed"], delta=1e-12)
            forces = np.loadtxt(self.folder / "dump.txt", skiprows=9)
            positions, _ = make_cell((1.1, 2, 0.1), (1.0, 1.0, 1.2))
            moment = forces[:162, 2:].T @ positions
            expected = -(moment + moment.T) / 2.0
            np.testing.assert_allclose(one[16:], [expected[0, 0], expected[1, 1], expected[2, 2],
                                                  expected[0, 1], expected[0, 2], expected[1, 2],
                                                  one[22]], atol=1e-11)
        # a cell stretched along z pulls the fluid inward along z: positive tension
        self.assertGreater(one[18], 0.0)

    def test_velocity_is_the_surface_mean(self):
        center = (0.05, 3.97, 2.0)
        positions, reference = make_cell(center, (1.3, 1.1, 0.6), 25.0)
        positions = positions * (1.0 + 0.1 * np.sin(positions[:, :1]))    # uneven mesh
        self.write((positions, reference))
        # a field that is periodic in the box, so that wrapped positions give it as well
        extra = COMPUTE + "variable vx atom sin(0.5*PI*x)+0.3\nvariable vy atom cos(0.5*PI*y)\n" \
            "variable vz atom -0.7\nvelocity all set v_vx v_vy v_vz\n"
        field = np.array([np.sin(0.5 * np.pi * positions[:, 0]) + 0.3,
                          np.cos(0.5 * np.pi * positions[:, 1]), -0.7 * np.ones(len(positions))]).T
        expected = compute_mean_over_surface(positions, field)
        for n_ranks in (1, 2, 4):
            np.testing.assert_allclose(self.row(n_ranks, extra=extra)[11:14], expected, atol=1e-12)

    def test_shear_carries_a_cell_over_flips(self):
        """A membrane too soft to matter moves with the flow, whose velocity is known."""
        rate, center = 1.0, np.array([2.0, 1.9, 3.8])
        styles = cases.STYLES.replace("1.0 20.0", "1e-13 0.0").replace("0.05", "0.0")
        # sheared backward first, so that edges are no longer at the end than at the start
        positions, reference = make_cell(center, (0.9, 0.8, 0.7))
        positions[:, 0] -= 0.9 * rate * (positions[:, 2] - center[2])
        self.write((positions, reference), tilt=(0.0, 0.0, 0.0))
        script = self.script(COMPUTE + "timestep 0.03\nthermo 10\nfix b all biem viscosity 1 "
                             f"accuracy 1e-2 flow shear xz {rate}\n", styles=styles)
        script = script.replace("comm_modify cutoff 1.5\n", "").replace("run 0", "run 60")
        for n_ranks in (1, 2):
            rows = cases.run_thermo(script, self.folder, n_ranks)
            volume = rows[0]["c_c[1][1]"]
            for thermo in rows:
                row = row_of(thermo, 1)
                self.assertAlmostEqual(row[0], volume, delta=1e-10)
                moved = center + [rate * center[2] * 0.03 * thermo["Step"], 0, 0]
                np.testing.assert_allclose(row[2:5], moved, atol=1e-10)
                np.testing.assert_allclose(row[11:14], [rate * center[2], 0, 0], atol=1e-10)
            self.assertEqual(len(rows), 7)


class Interface(CellCase):
    def test_averages_and_groups(self):
        self.write(make_cell((1.1, 2, 2), (0.8, 0.8, 0.9)), make_cell((3.1, 2, 2), (0.8, 1, 0.9)))
        extra = ("group second molecule 2\ncompute c second biem/cell\n"
                 "fix a all ave/time 1 1 1 c_c[1] c_c[2] mode vector file average.txt\n")
        columns = columns_of(1) + " " + columns_of(2)
        thermo = cases.run_thermo(self.script(extra, columns), self.folder)[-1]
        np.testing.assert_array_equal(row_of(thermo, 1), 0.0)
        volume, area = compute_volume_and_area(make_cell((3.1, 2, 2), (0.8, 1, 0.9))[0])
        self.assertAlmostEqual(row_of(thermo, 2)[0], volume, delta=1e-12)
        table = np.loadtxt(self.folder / "average.txt", skiprows=4)
        np.testing.assert_allclose(table, [[1, 0, 0], [2, volume, area]], rtol=1e-5)

    def test_molecules_without_triangles_have_zero_rows(self):
        self.write(make_cell((2, 2, 2), (0.8, 0.8, 0.9)))
        extra = ("create_atoms 1 single 0.1 0.1 0.1\ngroup new id 163\nset group new mol 3\n" +
                 COMPUTE)
        thermo = cases.run_thermo(self.script(extra, columns_of(1) + " " + columns_of(3)),
                                  self.folder)[-1]
        np.testing.assert_array_equal(row_of(thermo, 3), 0.0)
        self.assertGreater(row_of(thermo, 1)[0], 0.0)


class BadInput(CellCase):
    def test_arguments_and_molecules(self):
        self.write(make_cell((2, 2, 2), (0.8, 0.8, 0.9)))
        self.expect_error(self.script("compute c all biem/cell volume\n"), "no arguments", "volume")
        self.expect_error(self.script("set group all mol 0\n" + COMPUTE), "no cells")
        self.expect_error(self.script(COMPUTE + "set group all mol 2\n"), "row for each of 1",
                          "there are 2")
        self.expect_error(self.script("group part id 1:100\ncompute c part biem/cell\n"),
                          "only 100 of the 162 atoms of molecule 1")

    def test_image_flags_that_tear_a_cell(self):
        self.write(make_cell((2, 2, 4), (0.8, 0.8, 0.9)))
        self.expect_error(self.script("set group all image NULL NULL 0\n" + COMPUTE), "image flags",
                          "molecule 1")

    def test_inside_out_cell(self):
        positions, reference = make_cell((2, 2, 2), (0.8, 0.8, 0.9))
        self.write((positions * [-1, 1, 1] + [4, 0, 0], reference))
        self.expect_error(self.script(), "molecule 1", "volume", "counter-clockwise")


if __name__ == "__main__":
    unittest.main()
