"""Scenes with a wall, rigid particles, cells of two viscosity ratios, tracers and probes: number of
ranks, interruptions and restarts do not change them, nor do flips of a sheared box."""

import unittest

import numpy as np

import coupled_cases as scenes
import flow_cases as flow
from styles import membrane_cases as cases

SAME_RANKS, OTHER_RANKS = 1e-12, 1e-10
TIGHT = "solver/tolerance 1e-11"
N_STEPS = 20
HALF = N_STEPS // 2

# Bodies across faces, edges and the middle of the box.
BODIES = (scenes.make_wall() +
          scenes.make_body("sphere", (0.3, 1.5, 1.6), "stiff") +
          scenes.make_body("sphere", (3.2, 4.5, 4.3), "stiff") +
          scenes.make_body("sphere", (3.0, 5.8, 1.7), "soft") +
          scenes.make_particle((5.6, 1.7, 4.4), "plates", "platelet diameter 1.2 thickness 0.4",
                               more="orientation 1 0.5 0.3") +
          scenes.make_particle((2.9, 2.3, 2.4), "plates", "platelet diameter 1.2 thickness 0.4",
                               more="orientation 0.2 1 0.7") +
          scenes.make_points(((1.5, 3.0, 3.0), (4.6, 0.1, 5.9), (5.9, 3.0, 1.0)), "seeds") +
          "group old type 3\n" +
          scenes.make_points(((4.5, 3.1, 3.0), (0.1, 4.6, 0.2)), "all_points") +
          "group eyes subtract all_points old\n")
SURFACES = ("wall walls cells stiff viscosity/ratio 5 cells soft rigid plates force 0.3 0 0.1 "
            "tracers seeds probes eyes")
THERMO = ("thermo_style custom step pe f_b[1] f_b[2] f_b[11] f_b[14] f_b[17] f_b[20] f_b[23] "
          "f_b[5][1] f_b[5][4] f_b[5][8] f_b[5][10] f_b[5][14] f_b[5][17] f_b[2][21]\n"
          "thermo_modify norm no format float %.17g\nthermo 5\n")


class Case(flow.FlowCase):
    KIND = "mean 0.5 0.2 0"

    def make_fix(self, kind=None, more=TIGHT):
        return scenes.make_fix(SURFACES, kind or self.KIND, more=more)

    def whole_run(self, runs, n_ranks=1, kind=None, more=TIGHT, before="", name="whole.txt"):
        script = (before + scenes.make_header() + BODIES + scenes.STYLES +
                  self.make_fix(kind, more) + flow.make_dump(name, 5) + THERMO + runs)
        self.output = flow.run(script, self.folder, n_ranks)
        return flow.read_dump(self.folder / name)

    def restarted_run(self, file, n_steps, n_ranks=1, kind=None, more=TIGHT):
        script = (f"read_restart {file}\nneighbor 0.2 bin\n" + scenes.STYLES +
                  self.make_fix(kind, more) + flow.make_dump("second.txt", 5) + THERMO +
                  f"run {n_steps}\n")
        self.output = flow.run(script, self.folder, n_ranks)
        return flow.read_dump(self.folder / "second.txt")

    def rows(self):
        return {int(row["Step"]): row for row in cases.read_thermo(self.output)}

    def assert_same_rows(self, one, other, tolerance, skip=("f_b[11]",)):
        for step in sorted(set(one) & set(other)):
            for name, value in one[step].items():
                if name not in skip:
                    self.assertAlmostEqual(other[step][name], value, delta=tolerance,
                                           msg=f"{name} at step {step}")


class Ranks(Case):
    def test_numbers_and_layouts_of_ranks(self):
        for kind, stepper in (("mean 0.5 0.2 0", "ab2"), ("pressure/drop 1 0.3 0", "rkc2")):
            more = f"{TIGHT} stepper {stepper}"
            reference = self.whole_run(f"run {N_STEPS}\n", kind=kind, more=more)
            rows = self.rows()
            self.assertGreater(np.abs(reference[N_STEPS] - reference[0])[:, :3].max(), 0.03)
            for n_ranks, before in ((2, ""), (4, ""), (4, "processors 1 1 4\n"),
                                    (3, "processors 3 1 1\n")):
                with self.subTest(kind=kind, n_ranks=n_ranks, before=before):
                    other = self.whole_run(f"run {N_STEPS}\n", n_ranks, kind, more, before)
                    self.assert_same_frames(reference, other, OTHER_RANKS)
                    self.assert_same_rows(rows, self.rows(), 100.0 * OTHER_RANKS)


class Restart(Case):
    RUNS = f"run {HALF}\nwrite_restart middle\nrun {HALF}\n"

    def test_same_ranks(self):
        for n_ranks, kind in ((1, "mean 0.5 0.2 0"), (2, "pressure/drop 1 0.3 0")):
            with self.subTest(n_ranks=n_ranks):
                whole = self.whole_run(self.RUNS, n_ranks, kind)
                rows = self.rows()
                second = self.restarted_run("middle", HALF, n_ranks, kind)
                self.assertEqual(sorted(second), [10, 15, 20])
                self.assert_same_frames(second, whole, SAME_RANKS)
                self.assert_same_rows(self.rows(), rows, 10.0 * SAME_RANKS)

    def test_other_ranks(self):
        whole = self.whole_run(self.RUNS, 2)
        for n_ranks in (1, 4):
            second = self.restarted_run("middle", HALF, n_ranks)
            self.assert_same_frames(second, whole, OTHER_RANKS)

    def test_two_runs_equal_one(self):
        one = self.whole_run(f"run {N_STEPS}\n", more="")
        rows = self.rows()
        # Rounding is amplified where the iterations end early: by about 1/tolerance.
        for runs in (f"run {HALF}\nrun {HALF}\n", f"run {HALF}\nrun {HALF} pre no\n",
                     N_STEPS * "run 1\n"):
            two = self.whole_run(runs, more="", name="two.txt")
            self.assert_same_frames(one, two, OTHER_RANKS)
            self.assert_same_rows(rows, self.rows(), 10.0 * OTHER_RANKS)


class Sheared(flow.FlowCase):
    """A rigid sphere, a platelet and a viscous cell in a box that flips."""

    RATE, TIMESTEP, N_STEPS = 5.0, 0.02, 42    # tilt 0.6 a step: four flips of the box of 6
    BODIES = (scenes.make_body("sphere", (0.3, 1.5, 1.6), "stiff") +
              scenes.make_particle((5.6, 1.7, 4.4), "balls") +
              scenes.make_particle((2.9, 4.3, 5.9), "balls", "platelet diameter 1.5 thickness 0.5",
                                   more="orientation 1 0.5 0.3"))
    THERMO = "thermo_style custom step xz f_b[6]\nthermo 1\n"

    def script(self, tilt, runs, name):
        return (scenes.make_header(tilt=tilt, skin=1.3) + self.BODIES + scenes.STYLES +
                self.make_fix() + flow.make_dump(name) + self.THERMO + runs)

    def make_fix(self):
        return scenes.make_fix("cells stiff viscosity/ratio 5 rigid balls",
                               f"shear xz {self.RATE}", timestep=self.TIMESTEP,
                               more="solver/tolerance 1e-11")

    def trajectory(self, tilt, runs=None, n_ranks=1, name="flips.txt"):
        output = flow.run(self.script(tilt, runs or f"run {self.N_STEPS}\n", name), self.folder,
                          n_ranks)
        self.rows = cases.read_thermo(output)
        return flow.read_dump(self.folder / name)

    def test_flips_change_nothing(self):
        """Three tilts of two lattices and other ranks: the tilts 3 and -3 are the same lattice."""
        one = self.trajectory(3.0)
        flips = self.rows[-1]["f_b[6]"]
        self.assertEqual(flips, 5)
        for tilt, n_ranks in ((-3.0, 1), (3.0, 2), (-3.0, 4)):
            with self.subTest(tilt=tilt, n_ranks=n_ranks):
                other = self.trajectory(tilt, n_ranks=n_ranks, name="other.txt")
                self.assertEqual(self.rows[-1]["f_b[6]"], flips - (tilt < 0.0))
                self.assert_same_frames(one, other, 1e-9)

    def test_continuous_through_flips(self):
        """No jump of any unwrapped position: third differences stay those of smooth motion."""
        frames = self.trajectory(0.0)
        steps = [k for k in range(1, self.N_STEPS + 1)
                 if self.rows[k]["f_b[6]"] > self.rows[k - 1]["f_b[6]"]]
        self.assertEqual(len(steps), 4)
        x = np.array([frames[k][:, :3] for k in range(self.N_STEPS + 1)])
        jumps = np.abs(np.diff(x, n=3, axis=0)).max(axis=(1, 2))[2:]
        at_flips = np.array([jumps[k - 5:k].max() for k in steps if k > 6])
        self.assertLess(at_flips.max(), 1.5 * np.median(np.sort(jumps)[-20:]))

    def test_restart_between_flips(self):
        runs = "run 15\nwrite_restart middle\nrun 25\n"
        whole = self.trajectory(0.0, runs, 2)
        for n_ranks, tolerance in ((2, SAME_RANKS), (1, 1e-9)):
            script = ("read_restart middle\nneighbor 1.3 bin\n" + scenes.STYLES +
                      self.make_fix() + flow.make_dump("second.txt") + self.THERMO + "run 25\n")
            flow.run(script, self.folder, n_ranks)
            second = flow.read_dump(self.folder / "second.txt")
            self.assertEqual(len(second), 26)
            self.assert_same_frames(second, whole, tolerance)

    def test_lonely_sphere_follows_the_flow(self):
        """Its center moves with the flow, it turns at half the vorticity; images at 20 radii."""
        script = (scenes.make_header((20.0, 20.0, 20.0), skin=2.5) +
                  scenes.make_particle((1.0, 2.0, 19.5)) + scenes.STYLES +
                  scenes.make_fix("rigid balls", "shear xz 1.0", timestep=0.1) +
                  "thermo_style custom step f_b[6] f_b[1][1] f_b[1][2] f_b[1][3] f_b[1][4] "
                  "f_b[1][7] f_b[1][8] f_b[1][9] f_b[1][10] f_b[1][12]\n"
                  "thermo_modify format float %.15g\nthermo 1\nrun 30\n")
        for n_ranks in (1, 2):
            rows = cases.read_thermo(flow.run(script, self.folder, n_ranks))
            self.assertEqual(rows[-1]["f_b[6]"], 3)
            for row in rows:
                time = 0.1 * row["Step"]
                for column, value, tolerance in (
                        (1, 1.0 + 19.5 * time, 1e-5), (2, 2.0, 1e-5), (3, 19.5, 1e-5),
                        (4, 19.5, 1e-5), (7, 0.0, 1e-5), (8, 0.5, 2e-4), (9, 0.0, 1e-5),
                        (10, np.cos(0.25 * time), 1e-4), (12, np.sin(0.25 * time), 1e-4)):
                    self.assertAlmostEqual(row[f"f_b[1][{column}]"], value, delta=tolerance,
                                           msg=f"column {column} in step {row['Step']}")


class Boundaries(flow.FlowCase):
    def test_bodies_that_cross_the_boundaries_of_the_box(self):
        """A uniform flow moves all of them alike, several boxes far; image flags follow."""
        bodies = (scenes.make_body("sphere", (0.3, 1.5, 1.6), "stiff") +
                  scenes.make_particle((5.6, 1.7, 4.4)) + scenes.make_points(((3, 3, 5.9),)))
        velocity = np.array([30.0, -20.0, 10.0])
        script = (scenes.make_header() + bodies + scenes.STYLES +
                  scenes.make_fix("cells stiff viscosity/ratio 5 rigid balls tracers points",
                                  "mean 30 -20 10", timestep=0.02) +
                  "thermo_style custom step f_b[2][1] f_b[2][2] f_b[2][3] f_b[2][10]\n" +
                  flow.make_dump("far.txt", 10) + "dump w all custom 10 box.txt id x y z ix iy iz\n"
                  "dump_modify w sort id\nrun 40\n")
        for n_ranks in (1, 4):
            rows = cases.read_thermo(flow.run(script, self.folder, n_ranks))
            frames, boxes = (flow.read_dump(self.folder / name) for name in ("far.txt", "box.txt"))
            moved = velocity * 0.02 * 40
            np.testing.assert_allclose(frames[40][:, :3], frames[0][:, :3] + moved, rtol=0.0,
                                       atol=1e-3)    # the mesh of the cell relaxes
            self.assertLess(np.abs(boxes[40][:, :3] - 3.0).max(), 3.5)    # wrapped but for the skin
            self.assertGreater((boxes[40][:, 3:] - boxes[0][:, 3:])[:, 0].min(), 2.5)
            np.testing.assert_allclose([rows[-1][f"f_b[2][{k}]"] for k in (1, 2, 3)],
                                       np.array([5.6, 1.7, 4.4]) + moved, rtol=0.0, atol=1e-3)


if __name__ == "__main__":
    unittest.main()
