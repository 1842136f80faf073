"""Reading of data files and dumps, good and bad."""

import os
import tempfile
import unittest
import warnings

import numpy as np
from synthetic import Files, make_icosphere

from biem_analysis import BiemAnalysisError, CellMesh, CellShapes, universe
from biem_analysis.data_file import read_reference_shape

EXTRA_SECTIONS = """Pair Coeffs # zero

1

Angle Coeffs # biem/skalak

1 1.0 100.0

Dihedral Coeffs # biem/bend

1 0.0033 0.0875

biem_reference

2 9 9 9
1 1 2 3

other_fix

1 5
2 5

"""


class Input(unittest.TestCase):
    """Two spheres in files."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        sphere, self.triangles = make_icosphere(1)
        self.positions = np.concatenate([sphere + 3.0, sphere + 7.0])
        self.files = Files(folder.name, self.triangles, len(sphere), 2)
        self.data = self.files.write_data(self.positions)
        self.dump = self.files.write_dump([self.positions] * 3)

    def assert_refused(self, *words):
        """Analysis stops with a message that holds the words."""
        with self.assertRaises(BiemAnalysisError) as caught:
            CellShapes(universe(self.data, self.dump)).run()
        for word in words:
            self.assertIn(word, str(caught.exception))

    def edit(self, path, old, new, count=1):
        """Replace text in a file."""
        with open(path, encoding="utf-8") as stream:
            text = stream.read()
        self.assertIn(old, text)
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text.replace(old, new, count))

    def test_topology(self):
        system = universe(self.data, self.dump, dt=0.5)
        mesh = CellMesh(system)
        self.assertEqual((mesh.n_cells, len(mesh.nodes), len(mesh.triangles)), (2, 84, 160))
        self.assertEqual(system.trajectory.n_frames, 3)
        self.assertEqual([ts.time for ts in system.trajectory], [0.0, 50.0, 100.0])
        self.assertEqual(system.trajectory[1].data["step"], 100)
        np.testing.assert_allclose(system.atoms.positions, self.positions, atol=1e-6)
        np.testing.assert_allclose(system.trajectory.ts.data["positions"], self.positions,
                                   atol=1e-11)

    def test_sections_of_coefficients_and_fixes_are_skipped(self):
        self.data = self.files.write_data(self.positions, extra=EXTRA_SECTIONS)
        self.assertEqual(len(CellMesh(universe(self.data, self.dump)).triangles), 160)
        reference = read_reference_shape(self.data, [1, 2, 3])
        np.testing.assert_array_equal(reference, [[1, 2, 3], [9, 9, 9], [0, 0, 0]])

    def test_section_title_without_style(self):
        self.edit(self.data, "Atoms # molecular", "Atoms")
        self.assertEqual(CellMesh(universe(self.data, self.dump)).n_cells, 2)

    def test_dump_order_does_not_matter(self):
        with open(self.dump, encoding="utf-8") as stream:
            lines = stream.read().splitlines()
        size = 9 + len(self.positions)
        frames = [lines[k:k + 9] + lines[k + 9:k + size][::-1] for k in range(0, 3 * size, size)]
        with open(self.dump, "w", encoding="utf-8") as stream:
            stream.write("\n".join(sum(frames, [])) + "\n")
        system = universe(self.data, self.dump)
        np.testing.assert_allclose(system.atoms.positions, self.positions, atol=1e-6)

    def test_unfinished_last_frame_is_left_out(self):
        with open(self.dump, "rb+") as stream:
            stream.truncate(os.path.getsize(self.dump) - 20)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.assertEqual(universe(self.data, self.dump).trajectory.n_frames, 2)
        self.assertTrue(any("not complete" in str(item.message) for item in caught))

    def test_missing_reference(self):
        with self.assertRaisesRegex(BiemAnalysisError, "biem_reference.*without nofix"):
            read_reference_shape(self.data, [1])

    def test_dump_without_unwrapped_positions(self):
        self.dump = self.files.write_dump([self.positions], columns="id mol type x y z vx vy vz")
        self.assert_refused("xu yu zu", "dump_modify")

    def test_no_triangles(self):
        self.data = self.files.write_data(self.positions, triangles=np.zeros((0, 3), dtype=int))
        self.assert_refused("no triangles", "create_cells")

    def test_open_surface_names_the_molecule(self):
        self.data = self.files.write_data(self.positions)
        self.edit(self.data, self.last_line(self.data), "")
        self.assert_refused("molecule 2", "not closed")

    def last_line(self, path):
        """Last line of a file with its end."""
        with open(path, encoding="utf-8") as stream:
            return stream.readlines()[-1]

    def test_two_surfaces_in_one_molecule(self):
        self.files.n_nodes, self.files.n_cells = 84, 1
        both = np.concatenate([self.triangles, self.triangles + 42])
        self.data = self.files.write_data(self.positions, triangles=both)
        self.assert_refused("molecule 1", "molecule id")

    def test_unknown_atom_style(self):
        self.edit(self.data, "Atoms # molecular", "Atoms # hybrid sphere")
        self.assert_refused("hybrid sphere", "molecular")

    def test_other_atoms_in_dump(self):
        self.dump = self.files.write_dump([self.positions[:42]])
        self.assert_refused("different atoms", "84")

    def test_atoms_change(self):
        self.dump = self.files.write_dump([self.positions, self.positions[:42]])
        self.assert_refused("42 atoms", "must not change")

    def test_failed_run(self):
        broken = self.positions.copy()
        broken[5, 1] = np.nan
        self.dump = self.files.write_dump([self.positions, broken])
        self.assert_refused("yu", "step 100")

    def test_torn_cell(self):
        torn = self.positions.copy()
        torn[50, 0] += 12.0
        self.dump = self.files.write_dump([self.positions, torn])
        self.assert_refused("molecule 2", "frame 1", "xu yu zu")

    def test_not_a_dump(self):
        self.dump = self.data
        self.assert_refused("not a text dump")

    def test_not_a_data_file(self):
        self.data = self.dump
        self.assert_refused("not a LAMMPS data file")

    def test_damaged_header(self):
        self.edit(self.dump, "ITEM: BOX BOUNDS pp pp pp\n0 12", "ITEM: BOX BOUNDS pp pp pp\n0 ?")
        self.assert_refused("damaged")

    def test_wrong_shear_plane(self):
        with self.assertRaisesRegex(BiemAnalysisError, "xx"):
            CellShapes(universe(self.data, self.dump), shear_plane="xx")


if __name__ == "__main__":
    unittest.main()
