"""Interrupted and restarted runs follow the trajectory of the run that was not interrupted, on any
number of ranks and across a flip of the box: Adams-Bashforth, whose history is part of a restart,
and Euler. Large steps of stages are in test_steppers.py."""

import unittest

import flow_cases as flow
from styles import membrane_cases as cases

N_STEPS = 60
HALF = N_STEPS // 2
SAME_RANKS, OTHER_RANKS = 1e-12, 1e-10
AB2 = "stepper ab2"
CELLS = (((0.1, 5.9, 0.05), 30.0), ((3.0, 2.9, 5.8), 80.0))

# The tilt grows by 6 * 0.004 in a step: the box flips in step 5, or in step 34, past the restart.
FLIP_BEFORE, FLIP_AFTER = 2.9, 2.2
THERMO = "thermo_style custom step xz f_b[5] f_b[6]\nthermo_modify format float %.15g\n"


class Case(flow.FlowCase):
    def write_cells(self, tilt):
        self.write(*(flow.make_red_cell(*cell) for cell in CELLS), tilt=(0.0, tilt, 0.0))

    def rows(self):
        return cases.read_thermo(self.output)

    def whole_run(self, runs, n_ranks=1, more=AB2, kind="shear xz 1.0", name="whole.txt"):
        script = flow.make_script(self.data, flow.make_styles(), flow.make_flow(kind, more=more),
                                  flow.make_dump(name, 10), runs)
        self.output = flow.run(script, self.folder, n_ranks)
        return flow.read_dump(self.folder / name)

    def restarted_run(self, file, n_steps, n_ranks=1, more=AB2, kind="shear xz 1.0"):
        script = (f"read_restart {file}\nneighbor 0.2 bin\npair_style none\n" +
                  flow.make_flow(kind, more=more) + flow.make_dump("second.txt", 10) +
                  THERMO + f"run {n_steps}\n")
        self.output = flow.run(script, self.folder, n_ranks)
        return flow.read_dump(self.folder / "second.txt")


class Restart(Case):
    def test_restart_in_the_middle(self):
        runs = f"run {HALF}\nwrite_restart middle\nrun {HALF}\n"
        for tilt, stepper in ((FLIP_BEFORE, "ab2"), (FLIP_AFTER, "ab2"), (FLIP_AFTER, "euler")):
            self.write_cells(tilt)
            more = f"stepper {stepper}"
            whole = self.whole_run(runs, more=more)
            for n_ranks, tolerance in ((1, SAME_RANKS), (2, OTHER_RANKS)):
                with self.subTest(tilt=tilt, stepper=stepper, n_ranks=n_ranks):
                    second = self.restarted_run("middle", HALF, n_ranks, more)
                    self.assertEqual(sorted(second), list(range(HALF, N_STEPS + 1, 10)))
                    self.assert_same_frames(second, whole, tolerance)
                    row = self.rows()[-1]
                    self.assertAlmostEqual(row["f_b[5]"], 0.24, delta=1e-12)
                    self.assertEqual(row["f_b[6]"], 1)

    def test_restart_on_fewer_ranks(self):
        self.write_cells(FLIP_AFTER)
        whole = self.whole_run(f"run {HALF}\nwrite_restart middle\nrun {HALF}\n", n_ranks=4)
        for n_ranks, tolerance in ((4, SAME_RANKS), (2, OTHER_RANKS), (1, OTHER_RANKS)):
            second = self.restarted_run("middle", HALF, n_ranks)
            self.assert_same_frames(second, whole, tolerance)

    def test_files_written_during_the_run(self):
        self.write_cells(FLIP_AFTER)
        whole = self.whole_run(f"restart 20 part.*\nrun {N_STEPS}\n")
        for step in (20, 40):
            second = self.restarted_run(f"part.{step}", N_STEPS - step)
            self.assert_same_frames(second, whole, SAME_RANKS)

    def test_restart_of_a_restart(self):
        self.write_cells(FLIP_AFTER)
        whole = self.whole_run(f"restart 20 part.*\nrun {N_STEPS}\n")
        script = ("read_restart part.20\nneighbor 0.2 bin\npair_style none\n" +
                  flow.make_flow(more=AB2) + "run 0\nwrite_restart again\n")
        flow.run(script, self.folder)
        second = self.restarted_run("again", N_STEPS - 20)
        self.assert_same_frames(second, whole, SAME_RANKS)

    def test_flow_at_rest_and_mean_flow(self):
        for kind in ("none", "mean 0.3 -0.2 0.5"):
            self.write_cells(0.7)
            whole = self.whole_run(f"run {HALF}\nwrite_restart middle\nrun {HALF}\n", kind=kind)
            second = self.restarted_run("middle", HALF, kind=kind)
            self.assert_same_frames(second, whole, SAME_RANKS)

    def test_other_split(self):
        more = f"{AB2} ewald spme"
        self.write_cells(FLIP_AFTER)
        whole = self.whole_run(f"run {HALF}\nwrite_restart middle\nrun {HALF}\n", more=more)
        self.assertIn("SPME, Gaussian split", self.output)
        second = self.restarted_run("middle", HALF, more=more)
        self.assert_same_frames(second, whole, SAME_RANKS)

    def test_another_shear_rate_after_the_restart(self):
        self.write_cells(0.0)
        self.whole_run("run 30\nwrite_restart middle\n")
        second = self.restarted_run("middle", 20, kind="shear xz 2.0")
        self.assertEqual(max(second), 50)
        row = self.rows()[-1]
        self.assertAlmostEqual(row["f_b[5]"], 0.004 * (30 + 2 * 20), delta=1e-12)
        self.assertAlmostEqual(row["Xz"], 6.0 * 0.004 * (30 + 2 * 20), delta=1e-12)


class SplitRuns(Case):
    def test_two_runs_equal_one(self):
        for stepper in ("ab2", "euler"):
            self.write_cells(FLIP_AFTER)
            more = f"stepper {stepper}"
            one = self.whole_run(f"run {N_STEPS}\n", more=more)
            two = self.whole_run(f"run {HALF}\nrun {HALF}\n", more=more, name="two.txt")
            self.assert_same_frames(one, two, SAME_RANKS)

    def test_every_step_a_run_of_its_own(self):
        self.write_cells(FLIP_BEFORE)
        one = self.whole_run("run 20\n")
        many = self.whole_run(20 * "run 1\n", name="many.txt")
        self.assert_same_frames(one, many, SAME_RANKS)

    def test_runs_without_setup(self):
        self.write_cells(FLIP_BEFORE)
        one = self.whole_run("run 20\n")
        for runs in ("run 10\nrun 10 pre no\n", "run 20 every 7 'print next'\n"):
            two = self.whole_run(runs, name="two.txt")
            self.assert_same_frames(one, two, SAME_RANKS)

    def test_changed_timestep_and_count_of_steps_keep_the_strain(self):
        self.write_cells(-2.0)
        self.whole_run(THERMO + "run 10\ntimestep 0.002\nrun 20\ntimestep 0.006\nrun 10\n"
                       "undump d\nreset_timestep 5\nrun 10\n")
        for row, step, strain in zip(self.rows()[1::2], (10, 30, 40, 15), (0.04, 0.08, 0.14, 0.2)):
            self.assertEqual(row["Step"], step)
            self.assertAlmostEqual(row["f_b[5]"], strain, delta=1e-12)
            self.assertAlmostEqual(row["Xz"], -2.0 + 6.0 * strain, delta=1e-12)

    def test_fix_defined_anew(self):
        """Starts from the box and the cells as they are, with an Euler step."""
        self.write_cells(FLIP_BEFORE)
        anew = ("undump d\nunfix b\n" + flow.make_flow("shear xz -0.5", more=AB2) + THERMO +
                "run 10\n")
        self.whole_run("run 20\n" + anew)
        row = self.rows()[-1]
        self.assertAlmostEqual(row["f_b[5]"], -0.5 * 0.04, delta=1e-12)
        self.assertAlmostEqual(row["Xz"], FLIP_BEFORE + 6.0 * (0.08 - 0.02) - 6.0, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
