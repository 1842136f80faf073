"""Bad input of fix biem stops with a message of its own, and before any file is written over."""

import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import flow_cases as flow
from styles import membrane_cases as cases

KEPT = "numbers of an earlier run\n"
DUMP = "dump d all custom 1 user.txt id x y z\n"
RUN = "run 2\n"
N_NODES, N_TRIANGLES = 162, 320
CENTERS = (1.5, 1.6, 1.7), (1.5, 1.6, 4.6)


class InputCase(flow.FlowCase):
    """Two spheres of 162 nodes in a box of 3 x 3 x 6."""

    BOX = (3.0, 3.0, 6.0)

    def setUp(self):
        super().setUp()
        self.write_spheres()

    def write_spheres(self, **options):
        sphere, _ = cases.make_icosphere()
        self.write(*((sphere + center, sphere) for center in CENTERS),
                   **dict({"box": self.BOX}, **options))

    def edit_angles(self, edit):
        """edit: list of triangles (lists of atom ids) -> new list."""
        text = self.data.read_text()
        head, rest = text.split("\nAngles\n\n")
        rows, tail = rest.split("\n\n", 1)
        triangles = edit([list(map(int, row.split()[2:])) for row in rows.splitlines()])
        head = head.replace(f"{2 * N_TRIANGLES} angles", f"{len(triangles)} angles")
        rows = "\n".join(f"{k + 1} 1 {a} {b} {c}" for k, (a, b, c) in enumerate(triangles))
        self.data.write_text(head + "\nAngles\n\n" + rows + "\n\n" + tail)

    def script(self, fix=None, before="", after=DUMP, end=RUN, styles=None):
        """before, after: commands around fix biem."""
        return flow.make_script(self.data, flow.make_styles() if styles is None else styles,
                                before, flow.make_flow() if fix is None else fix, after, end)

    def expect_error(self, script, *parts, n_ranks=1, is_kept=True, folder=None):
        """Refused, and the user's file is kept where that happens before the run."""
        user_file = (folder or self.folder) / "user.txt"
        user_file.write_text(KEPT)
        super().expect_error(script, *parts, n_ranks=n_ranks, folder=folder)
        if is_kept:
            self.assertEqual(user_file.read_text(), KEPT)

    def expect_errors(self, scripts_and_parts):
        """Many at a time: a short run of LAMMPS mostly waits for MPI to start."""
        def check(case):
            with tempfile.TemporaryDirectory(dir=self.folder) as folder:
                self.expect_error(case[0], *case[1], folder=Path(folder))

        with ThreadPoolExecutor(4) as pool:
            checks = [(case, pool.submit(check, case)) for case in scripts_and_parts]
        for (script, parts), done in checks:
            with self.subTest(script=script, parts=parts):
                done.result()

    def expect_argument_errors(self, arguments_and_parts):
        self.expect_errors([(self.script(f"timestep 0.004\nfix b all biem {arguments}\n"), parts)
                            for arguments, parts in arguments_and_parts])


class Accepted(InputCase):
    def test_the_case_without_a_mistake(self):
        for kind, more in (
                ("shear xz 1.0", "stepper rkc2 error/tolerance 1e-3 multirate yes hold area"),
                ("shear xz 0.0", "stepper euler watch off"),
                ("mean 1 0 0", "watch edge 3 area 2 crossings 0 multirate no hold volume"),
                ("none", "stepper ab2 hold none")):
            fix = flow.make_flow(kind, more=more + " traction consistent cells all")
            flow.run(self.script(fix), self.folder)
            self.assertIn("NUMBER OF ATOMS", (self.folder / "user.txt").read_text())

    def test_force_before_the_fix_counts(self):
        speeds = []
        for before in ("", "fix push all addforce 0.0 0.5 0.0\n"):
            output = flow.run(self.script(flow.make_flow("none"), before,
                                          "thermo_style custom step f_b[4]\n", "run 0\n"),
                              self.folder)
            speeds.append(cases.read_thermo(output)[-1]["f_b[4]"])
        self.assertLess(speeds[0], 0.1 * speeds[1])

    def test_styles_come_back_after_clear(self):
        script = self.script(after="thermo_style custom step f_b[4]\n")
        once = cases.read_thermo(flow.run(script, self.folder))
        rows = cases.read_thermo(flow.run(script + "clear\n" + script, self.folder))
        self.assertEqual(rows, once + once)


class GivenParameters(InputCase):
    """Parameters of the periodic sum that the user fixes."""

    def evaluate(self, more):
        """Output, expected error and rms velocity of two spheres that are pushed."""
        fix = flow.make_flow(more=more)
        output = flow.run(self.script(fix, "fix push all addforce 0.0 0.5 0.0\n",
                                      "thermo_style custom step f_b[3] f_b[10]\n", "run 0\n"),
                          self.folder)
        row = cases.read_thermo(output)[-1]
        return output, row["f_b[10]"], row["f_b[3]"]

    def test_they_are_used_and_printed(self):
        chosen, chosen_error, chosen_velocity = self.evaluate("")
        self.assertNotIn("WARNING: Fix biem: expected error", chosen)
        self.assertLess(chosen_error, 1e-3)
        # band limit: PSWF splitting + 0.35/cutoff
        for more, parts in (
                ("cutoff 1.25", ("cutoff 1.25,",)),
                ("order 9 ewald pswf", ("PSWF", "window order 9\n")),
                ("ewald spme", ("SPME, Gaussian split, B-splines",)),
                ("cutoff 1.2 splitting 10 order 8 grid 20 18 36",
                 ("cutoff 1.2,", "band limit 10.29,", "grid 20 x 18 x 36, window order 8\n"))):
            with self.subTest(more=more):
                text, error, velocity = self.evaluate(more)
                for part in parts:
                    self.assertIn(part, text)
                self.assertNotIn("WARNING: Fix biem: expected error", text)
                self.assertLess(error, 1e-3)
                self.assertLess(abs(velocity / chosen_velocity - 1.0), 1e-3)

    def test_too_coarse_parameters_run_with_a_warning(self):
        for more in ("grid 5 5 6", "cutoff 0.6 grid 10 10 20", "splitting 1 cutoff 0.8",
                     "ewald spme splitting 1 cutoff 0.8"):
            with self.subTest(more=more):
                text, error, _ = self.evaluate(more)
                self.assertGreater(error, 1e-3)
                self.assertIn(f"requested error 0.001, expected {float(f'{error:.2g}'):g}\n", text)
                self.assertEqual(text.count("WARNING: Fix biem: expected error"), 1)
                self.assertRegex(text, "WARNING.*larger than accuracy 0.001.*splitting.*grid")


    def test_a_grid_alone_gets_the_cutoff_that_fits_it(self):
        text, error, _ = self.evaluate("grid 8 8 16")
        self.assertNotIn("WARNING: Fix biem: expected error", text)
        self.assertLess(error, 1e-3)


class Meshes(InputCase):
    def test_open_surface(self):
        self.edit_angles(lambda t: t[:N_TRIANGLES + 7] + t[N_TRIANGLES + 8:])
        for n_ranks in (1, 2):
            self.expect_error(self.script(), "molecule 2 is open", n_ranks=n_ranks)

    def test_turned_triangle(self):
        def turn(triangles):
            triangles[9] = triangles[9][::-1]
            return triangles
        self.edit_angles(turn)
        for n_ranks in (1, 2):
            self.expect_error(self.script(), "molecule 1", "not consistently oriented",
                              "counter-clockwise", n_ranks=n_ranks)

    def test_triangle_listed_twice(self):
        self.edit_angles(lambda t: t + [t[-1]])
        self.expect_error(self.script(), "molecule 2", "more than two triangles")

    def test_inside_out(self):
        self.edit_angles(lambda t: t[:N_TRIANGLES] + [c[::-1] for c in t[N_TRIANGLES:]])
        self.expect_error(self.script(), "molecule 2", "inside out")

    def test_two_molecules_in_a_triangle(self):
        self.expect_error(self.script(before="set atom 5 mol 2\n"), "molecule")
        self.expect_error(self.script(before="set group all mol 0\n"), "molecule")

    def test_missing_atom(self):
        before = "group lost id 7\ndelete_atoms group lost compress no mol no\n"
        self.expect_error(self.script(before=before), "atom 7", "does not exist")

    def test_reference(self):
        sphere, _ = cases.make_icosphere()
        made = [(sphere + center, sphere * 0.0) for center in CENTERS]
        self.write(*made, box=self.BOX)
        self.expect_error(self.script(), "missing or all zero")
        self.write(*made, box=self.BOX, with_reference=False)
        script = self.script().replace(" fix biem_reference NULL biem_reference", "")
        self.expect_error(script, "missing or all zero")
        self.expect_error(script.replace("fix biem_reference all property/atom", "#"),
                          "d2_biem_reference")

    def test_long_edges(self):
        sphere, _ = cases.make_icosphere()
        self.write((sphere * [8.0, 1.0, 1.0] + 2.0, sphere), box=(4.0, 4.0, 4.0))
        self.expect_error(self.script(), "longest mesh edge", "half of the shortest box length")

    def test_torn_images(self):
        before = "set atom 5 image 1 0 0\n"
        self.expect_error(self.script(before=before), "longest mesh edge", "image flags")


class Groups(InputCase):
    def test_atoms_in_no_group_and_in_two(self):
        groups = "group one molecule 1\ngroup two molecule 2\n"
        scripts = []
        for more, parts in (("cells one", ("atom 163", "in none of the groups", "tracers")),
                            ("cells all tracers two", ("atom 163", "must not overlap")),
                            ("tracers two", ("atom 163", "vertex", "not in the cells")),
                            ("cells three", ("group 'three'", "does not exist")),
                            ("tracers three", ("group 'three'", "does not exist"))):
            scripts.append((self.script(flow.make_flow(more=more), groups), parts))
        self.expect_errors(scripts)
        self.expect_error(self.script(flow.make_flow().replace("fix b all", "fix b one"), groups),
                          "atom 163", "in none of the groups")

    def test_point_without_triangles_in_the_cells(self):
        before = "create_atoms 1 single 0.1 0.1 0.1\nset atom 325 mol 1\n"
        self.expect_error(self.script(before=before), "atom 325", "in no triangle", "tracers")

    def test_force_on_a_tracer(self):
        before = ("create_atoms 1 single 0.1 0.1 0.1\ngroup points id 325\n"
                  "fix push points addforce 1.0 0.0 0.0\n")
        self.expect_error(self.script(flow.make_flow(more="tracers points"), before),
                          "acts on atom 325", "tracers", is_kept=False)


class Arguments(InputCase):
    def test_numbers(self):
        good = "viscosity 1 accuracy 1e-3 flow shear xz 1.0 cutoff 0.5"
        keywords = {"viscosity 1": ("0", "-1.0", "1e400"), "cutoff 0.5": ("0", "-2", "1e-3", "1e3"),
                    "accuracy 1e-3": ("0", "-1", "1e-16", "2"), "shear xz 1.0": ("1e400",)}
        self.expect_argument_errors([
            (good.replace(old, old.rsplit(" ", 1)[0] + " " + bad), (old.split()[0] + "|1e400",))
            for old, values in keywords.items() for bad in values])
        mean = good.replace("shear xz 1.0", "mean 1 0 -1e400")
        self.expect_argument_errors([(mean, ("-1e400",))])
        # words and NaN are refused by LAMMPS, with the word in its message
        self.expect_argument_errors([
            (good.replace(old, old.rsplit(" ", 1)[0] + " " + bad), (f"'{bad}'",))
            for old in keywords for bad in ("nan", "thick")])

    def test_parameters_of_the_periodic_sum(self):
        good = "viscosity 1 accuracy 1e-3 flow none "
        allowed = "allowed are integers from {} to {}"
        self.expect_argument_errors([
            (good + "order 2", ("order 2 is out of range", allowed.format(3, 16))),
            (good + "order 99", ("order 99 is out of range", allowed.format(3, 16))),
            (good + "order x", ("'x'",)),
            (good + "order 6.5", ("'6.5'",)),
            (good + "order", ("'order' ends too early",)),
            (good + "grid 0 8 8", ("grid 0 is out of range", allowed.format(4, 4096))),
            (good + "grid 8 8 -8", ("grid -8 is out of range", allowed.format(4, 4096))),
            (good + "grid 8 8 1000000", ("grid 1000000 is out of range",)),
            (good + "grid 8 8", ("'grid' ends too early",)),
            (good + "grid 8 8 cutoff 1", ("'cutoff'",)),
            (good + "splitting -1", ("splitting -1 must be a positive number",)),
            (good + "splitting 0", ("splitting 0 must be a positive number",)),
            (good + "splitting nan", ("'nan'",)),
            (good + "splitting", ("'splitting' ends too early",)),
            (good + "cutoff 3.1", ("cutoff 3.1 is larger than the shortest box length 3",))] + [
                (good + given + " " + given, (f"keyword '{given.split()[0]}' is given twice",))
                for given in ("order 6", "grid 16 16 32", "splitting 9", "cutoff 1",
                              "ewald pswf")])

    def test_words(self):
        good = "viscosity 1 accuracy 1e-3 flow none "
        self.expect_argument_errors([
            (good + "colour red", ("unknown keyword 'colour'", "allowed are")),
            (good + "viscosity 2", ("keyword 'viscosity' is given twice",)),
            (good + "flow none", ("keyword 'flow' is given twice",)),
            ("viscosity 1 accuracy 1e-3", ("keyword 'flow' is missing",)),
            ("viscosity 1 flow none", ("keyword 'accuracy' is missing",)),
            ("accuracy 1e-3 flow none", ("keyword 'viscosity' is missing",)),
            ("viscosity 1 accuracy 1e-3 flow", ("'flow' ends too early",)),
            ("viscosity 1 accuracy 1e-3 flow mean 1 0", ("'flow mean' ends too early",)),
            ("viscosity 1 accuracy 1e-3 flow shear xy 1", ("flow shear xy", "shear xz")),
            ("viscosity 1 accuracy 1e-3 flow pipe", ("unknown flow 'pipe'",)),
            (good + "stepper rk4", ("unknown stepper 'rk4'", "rkc2", "ab2", "euler")),
            (good + "stepper", ("'stepper' ends too early",)),
            (good + "ewald direct", ("unknown ewald method 'direct'", "spme", "pswf")),
            (good + "tune guess", ("unknown tuning 'guess'", "model", "search")),
            (good + "tune", ("'tune' ends too early",)),
            (good + "traction smooth", ("unknown traction 'smooth'", "lumped", "consistent"))])

    def test_coefficients(self):
        styles, scripts = flow.make_styles(), []
        for old, new, part in (
                ("2.0 100.0", "0 100.0", "ES"), ("2.0 100.0", "-2.0 100.0", "ES"),
                ("2.0 100.0", "1e400 100.0", "ES|1e400"), ("2.0 100.0", "2.0 -1", "ED"),
                ("2.0 100.0", "2.0 1e400", "ED|1e400"), ("0.0066", "-1.0", "EB"),
                ("0.0066", "1e400", "EB|1e400"), ("sphere", "1e400", "beta0|1e400"),
                ("2.0 100.0", "nan 100.0", "nan"), ("0.0066", "nan", "nan")):
            self.assertIn(old, styles)
            scripts.append((self.script(styles=styles.replace(old, new)), (part,)))
        self.expect_errors(scripts)


class Settings(InputCase):
    def test_newton_off(self):
        script = self.script().replace("newton on", "newton off")
        self.expect_error(script, "newton on")

    def test_communication_cutoff(self):
        self.expect_error(self.script(before="comm_modify cutoff 0.5\n"),
                          "communication cutoff 0.5 is too small", "needed", "comm_modify")

    def test_boundaries_and_box(self):
        script = self.script(flow.make_flow("none"))
        self.write_spheres(tilt=None)
        for boundary in ("p p f", "s p p", "p m p"):
            self.expect_error(script.replace("boundary p p p", "boundary " + boundary),
                              "boundary p p p")
        self.expect_error(self.script(), "flow shear needs a triclinic box", "prism")

    def test_other_fixes(self):
        scripts = []
        for command, parts in (
                ("fix n all nve", ("fix n (nve)", "moves atoms")),
                ("fix m all move linear 1 0 0", ("fix m (move)", "moves atoms")),
                ("fix h all press/berendsen iso 1 1 1", ("press/berendsen",)),
                ("fix c all biem viscosity 1 accuracy 1e-3 flow none", ("only one fix", "'c'"))):
            scripts.append((self.script(before=command + "\n"), parts))
            scripts.append((self.script(after=DUMP + command + "\n"), parts))
        self.expect_errors(scripts)

    def test_deformed_box(self):
        deform = "fix d all deform 1 xz erate 1.0 remap none\n"
        # LAMMPS itself sees two fixes for one tilt
        self.expect_error(self.script(before=deform), "multiple fixes change box parameter xz")
        self.expect_error(self.script(flow.make_flow("none"), deform), "fix d (deform)",
                          "owns the tilt")

    def test_forces_after_the_fix(self):
        for command in ("fix f all addforce 1 0 0", "fix f all setforce 0 NULL NULL"):
            self.expect_error(self.script(after=DUMP + command + "\n"),
                              f"fix f ({command.split()[3]})", "define it before fix biem")

    def test_neighbor_settings(self):
        self.expect_error(self.script(before="neigh_modify check no\n"),
                          "'neigh_modify check yes' is required")
        self.expect_error(self.script(before="neigh_modify exclude molecule/intra all\n"),
                          "neigh_modify exclude")

    def test_run_style_and_timestep(self):
        self.expect_error(self.script(after=DUMP + "run_style respa 2 2 improper 1\n"), "respa")
        for timestep in (0.0, -0.004):
            self.expect_error(self.script(flow.make_flow(timestep=timestep)), "timestep",
                              "positive")

    def test_change_of_the_number_of_cells(self):
        end = "run 0\ngroup two molecule 2\ndelete_atoms group two mol yes\nrun 0\n"
        self.expect_error(self.script(end=end, after=""), "number of surfaces has changed")

    def test_no_atom_map_or_molecules(self):
        script = self.script().replace("atom_modify map yes\n", "").replace("mass", "#mass")
        output = cases.run(script, self.folder).stdout    # style molecular makes a map by itself
        self.assertNotIn("Segmentation", output)
        points = ("units lj\natom_style atomic\nregion b prism 0 3 0 3 0 3 0 0 0\n"
                  "create_box 1 b\ncreate_atoms 1 random 5 1 b\nmass * 1\n" + flow.make_flow())
        self.expect_error(points, "molecule", "atom_style molecular")


class Positions(InputCase):
    def test_position_that_is_not_a_number(self):
        before = ("variable bad atom 1e308*1e308-1e308*1e308\n"
                  "set atom 17 {} v_bad\n")
        for axis, n_ranks in (("x", 1), ("y", 2), ("z", 1)):
            with self.subTest(axis=axis, n_ranks=n_ranks):
                self.expect_error(self.script(before=before.format(axis)), "atom 17", "step 0",
                                  n_ranks=n_ranks)

    def test_position_lost_between_runs(self):
        end = "run 2\nvariable bad atom 1e308*1e308-1e308*1e308\nset atom 17 y v_bad\nrun 2\n"
        self.expect_error(self.script(end=end), "atom 17", "step 2", is_kept=False)

    def test_force_that_is_not_a_number(self):
        before = ("variable bad atom step*1e308*(step*1e308)-step*1e308*(step*1e308)\n"
                  "group one id 17\nfix push one addforce v_bad 0 0\n")
        for n_ranks in (1, 2):
            self.expect_error(self.script(before=before), "atom 17", "molecule 1", "step 1",
                              n_ranks=n_ranks, is_kept=False)


if __name__ == "__main__":
    unittest.main()
