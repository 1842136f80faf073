"""The cell models in potentials/ load, and give the moduli they state."""

import tempfile
import unittest

import membrane_cases as cases

POTENTIALS = cases.SOURCE / "potentials"
STYLES = "pair_style zero 1.0\npair_coeff * *\nmass * 1.0\n" \
    "angle_style biem/skalak\ndihedral_style biem/bend\n"


class Potentials(unittest.TestCase):
    def load(self, name, settings):
        """The variables ES, ED, EB and the energy after the file was included."""
        with tempfile.TemporaryDirectory() as folder:
            data = f"{folder}/cells.data"
            reference, _ = cases.make_icosphere()
            cases.write_data(data, [(2.0 + reference * [1.1, 1.0, 0.9], reference)])
            script = (cases.HEADER + cases.READ.format(data=data) + STYLES + settings +
                      f"include {POTENTIALS}/{name}\n" +
                      cases.THERMO.format(columns="v_ES v_ED v_EB eangle edihed"))
            return cases.run_thermo(script, folder)[-1]

    def test_every_file_is_tested_and_documented(self):
        names = {path.name for path in POTENTIALS.glob("*.lmp")}
        self.assertEqual(names, {"red_cell_zhao2012.lmp", "red_cell_zhao2012_micro.lmp",
                                 "capsule_skalak.lmp"})
        readme = (POTENTIALS / "README.md").read_text()
        for name in names:
            self.assertIn(f"`{name}`", readme)

    def test_red_cell(self):
        row = self.load("red_cell_zhao2012.lmp", "variable Ca equal 0.5\n")
        self.assertAlmostEqual(row["v_ES"], 2.0, delta=1e-12)
        self.assertAlmostEqual(row["v_ED"], 100.0, delta=1e-12)
        self.assertAlmostEqual(row["v_EB"], 3.3e-3 * 2.0, delta=1e-12)
        self.assertGreater(row["E_angle"], 0.0)
        self.assertGreater(row["E_dihed"], 0.0)

    def test_red_cell_in_other_units(self):
        row = self.load("red_cell_zhao2012.lmp",
                        "variable Ca equal 2\nvariable viscosity equal 1.2\n"
                        "variable shear_rate equal 10\nvariable cell_radius equal 3\n"
                        "variable cell_type string 1\n")
        self.assertAlmostEqual(row["v_ES"], 18.0, delta=1e-12)
        self.assertAlmostEqual(row["v_ED"], 3600.0, delta=1e-9)
        self.assertAlmostEqual(row["v_EB"], 3.3e-3 * 18.0 * 9.0, delta=1e-12)

    def test_dimensional_red_cell_has_capillary_number_one_at_2009_per_second(self):
        row = self.load("red_cell_zhao2012_micro.lmp", "variable shear_rate equal 2.009e-3\n")
        self.assertAlmostEqual(row["v_ES"], 6.8e-3, delta=1e-12)
        self.assertAlmostEqual(row["v_ED"] / row["v_ES"], 100.0, delta=0.05)
        self.assertAlmostEqual(row["v_EB"], 1.785e-4, delta=1e-6)

    def test_capsule(self):
        row = self.load("capsule_skalak.lmp", "variable Ca equal 0.3\n")
        self.assertAlmostEqual(row["v_ES"], 1.0 / 0.3, delta=1e-12)
        self.assertAlmostEqual(row["v_ED"], 2.0 / 0.3, delta=1e-12)
        self.assertEqual(row["E_dihed"], 0.0)


if __name__ == "__main__":
    unittest.main()
