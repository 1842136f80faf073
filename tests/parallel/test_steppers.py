"""Every stepper gives one trajectory, whatever the number of ranks, wherever runs are split and
continued from restart files, and whatever the skin of the neighbor lists: with large steps, in
which lists are renewed and boxes flip between stages.  Steps by an error keep LAMMPS' clock."""

import re
import unittest

import numpy as np

import coupled_cases as scenes
import flow_cases as flow
from styles import membrane_cases as cases

SAME_RANKS, OTHER_RANKS = 1e-12, 1e-10
STIFFNESS = 10.0    # velocities of stiff membranes are less exact than positions
SAME_RANKS_OF_ERROR = 1e-10    # rounding changes the length of steps that follow from an error
TIGHT = "solver/tolerance 1e-11"

# name: keywords, timestep, number of steps
STEPPERS = {
    "euler": ("stepper euler", 0.004, 12),
    "ab2": ("stepper ab2", 0.004, 12),
    "rkc2": ("stepper rkc2", 0.1, 16),
    "error": ("error/tolerance 2e-3", 0.2, 16),
    "multirate": ("multirate yes", 0.05, 16),
    "multirate error": ("multirate yes error/tolerance 2e-3", 0.2, 12),
    "hold area": ("hold area", 0.1, 6),
}
CLOCK = ("Dt", "Xz", "f_b[5]", "f_b[6]", "f_b[26]", "f_b[28]")    # and stages
THERMO = ("thermo_style custom step time dt xz f_b f_b[1] f_b[5] f_b[6] f_b[26] f_b[27] f_b[28] "
          "f_b[29] f_b[30]\nthermo_modify norm no format float %.17g\nthermo 1\n")


class Scene(flow.FlowCase):
    """A scene with its styles and fix, runs of it and of its restart files."""

    STYLES_AGAIN = "pair_style none\n"

    def make_scene(self, skin):
        raise NotImplementedError

    def make_fix(self, more, timestep):
        raise NotImplementedError

    def run_script(self, script, name, n_ranks):
        self.output = flow.run(script, self.folder, n_ranks)
        self.rows = {}    # at the end of steps, not at the start of a later run
        for row in cases.read_thermo(self.output):
            self.rows.setdefault(int(row["Step"]), row)
        return flow.read_dump(self.folder / name)

    def trajectory(self, more, timestep, runs, n_ranks=1, name="other.txt", skin=0.2):
        return self.run_script(self.make_scene(skin) + self.make_fix(more, timestep) +
                               flow.make_dump(name) + THERMO + runs, name, n_ranks)

    def restarted(self, file, more, timestep, runs, n_ranks=1):
        return self.run_script(f"read_restart {file}\nneighbor 0.2 bin\n{self.STYLES_AGAIN}" +
                               self.make_fix(more, timestep) + flow.make_dump("second.txt") +
                               THERMO + runs, "second.txt", n_ranks)

    def assert_same(self, one, other, rows, tolerance):
        """Positions, velocities and clocks at the steps of the second. Velocities relative to the
        shear: those with it depend on which image of an atom LAMMPS stores."""
        for step in sorted(other):
            for part, rate in ((slice(0, 3), 1.0), (slice(6, 9), STIFFNESS)):
                np.testing.assert_allclose(other[step][:, part], one[step][:, part], rtol=0.0,
                                           atol=rate * tolerance, err_msg=f"step {step}")
            for name in CLOCK if step > min(other) else ():    # dt is that of the step before
                self.assertAlmostEqual(self.rows[step][name], rows[step][name],
                                       delta=10.0 * tolerance, msg=f"{name} at step {step}")
            # The stiffness is estimated at the same steps: it grows by 1 % from one to the next.
            self.assertAlmostEqual(self.rows[step]["f_b[27]"], rows[step]["f_b[27]"],
                                   delta=1e-3 * rows[step]["f_b[27]"], msg=f"radius, step {step}")

    def check_ranks_and_restarts(self, steppers, n_ranks=2):
        for stepper in steppers:
            more, timestep, n_steps = STEPPERS[stepper]
            middle = n_steps // 2
            runs = f"restart {middle} part.*\nrun {n_steps}\n"
            one = self.trajectory(more, timestep, runs)
            rows = self.rows
            self.assertGreater(np.abs(one[n_steps] - one[0])[:, :3].max(), 0.01)
            with self.subTest(stepper=stepper, n_ranks=n_ranks):
                other = self.trajectory(more, timestep, runs, n_ranks)
                self.assertEqual(len(other), n_steps + 1)
                self.assert_same(one, other, rows, OTHER_RANKS)
            rows = self.rows
            same = SAME_RANKS_OF_ERROR if "error" in stepper else SAME_RANKS
            for n, tolerance in ((n_ranks, same), (1, OTHER_RANKS)):
                with self.subTest(stepper=stepper, n_ranks=n_ranks, restarted_on=n):
                    second = self.restarted(f"part.{middle}", more, timestep,
                                            f"run {n_steps - middle}\n", n)
                    self.assertEqual(sorted(second), list(range(middle, n_steps + 1)))
                    self.assert_same(other, second, rows, tolerance)

    def check_split(self, steppers):
        for stepper in steppers:
            more, timestep, n = STEPPERS[stepper]
            one = self.trajectory(more, timestep, f"run {n}\n")
            rows = self.rows
            same = SAME_RANKS_OF_ERROR if "error" in stepper else SAME_RANKS
            for runs in (f"run 0\nrun {n // 2}\nrun {n - n // 2} pre no\n", n * "run 1\n",
                         f"run {n} every 3 'print next'\n"):
                with self.subTest(stepper=stepper, runs=runs):
                    two = self.trajectory(more, timestep, runs)
                    self.assert_same(one, two, rows, same)


class CellScene(Scene):
    """Two red cells of ratio 1 across the boundaries of a sheared box: its tilt passes 3, half a
    box length, twice with the larger steps."""

    def setUp(self):
        super().setUp()
        self.write(flow.make_red_cell((0.1, 5.9, 0.05), 30.0),
                   flow.make_red_cell((3.0, 2.9, 5.8), 80.0), tilt=(0.0, 2.9, 0.0))

    def make_scene(self, skin):
        return (flow.make_header(skin=skin) + cases.READ.format(data=self.data) +
                flow.make_styles())

    def make_fix(self, more, timestep):
        return flow.make_flow("shear xz 1.0", timestep=timestep, more=more)


class Cells(CellScene):
    def test_ranks_and_restarts(self):
        self.check_ranks_and_restarts(STEPPERS)

    def test_four_ranks(self):
        self.check_ranks_and_restarts(["rkc2"], 4)

    def test_split_runs(self):
        self.check_split(["ab2", "rkc2", "error", "multirate"])

    def test_no_step_changes_what_is_seen_at_its_end(self):
        """run 0 shows the velocities of the step before."""
        for stepper in ("rkc2", "error", "multirate"):
            more, timestep, _ = STEPPERS[stepper]
            one = self.trajectory(more, timestep, "run 3\n")
            self.trajectory(more, timestep, "run 3\nundump d\n" + flow.make_dump("zero.txt") +
                            "run 0\n")
            zero = flow.read_dump(self.folder / "zero.txt")
            np.testing.assert_allclose(zero[3][:, :3], one[3][:, :3], rtol=0.0, atol=SAME_RANKS)
            np.testing.assert_allclose(zero[3][:, 6:9], one[3][:, 6:9], rtol=0.0, atol=1e-11)


class Lists(CellScene):
    def count_renewed(self):
        found = re.search(r"(\d+) neighbor lists renewed within steps", self.output)
        return int(found.group(1)) if found else 0

    def test_skins_change_nothing(self):
        """Lists of one step, or of several, or of a part of one: the same sums."""
        for more, timestep in (("", 0.1), ("multirate yes", 0.1)):
            one = self.trajectory(more, timestep, "run 8\n", skin=1.0)
            rows, few = self.rows, self.count_renewed()
            for skin, n_ranks in ((0.1, 1), (0.01, 1), (0.03, 2)):
                with self.subTest(more=more, skin=skin, n_ranks=n_ranks):
                    other = self.trajectory(more, timestep, "run 8\n", n_ranks, skin=skin)
                    self.assert_same(one, other, rows, 1e-11 if n_ranks == 1 else OTHER_RANKS)
                    self.assertGreater(self.count_renewed(), few)
                    self.assertGreaterEqual(self.count_renewed(), 8)    # in every step


class Walls(Scene):
    """A wall, a platelet with a force, a cell of ratio 5, one of ratio 1, tracers."""

    STYLES_AGAIN = scenes.STYLES

    def make_scene(self, skin):
        return (scenes.make_header(skin=skin) + scenes.make_wall() +
                scenes.make_body("sphere", (0.3, 1.5, 1.6), "stiff") +
                scenes.make_body("sphere", (3.0, 5.8, 1.7), "soft") +
                scenes.make_particle((5.6, 1.7, 4.4), "plates",
                                     "platelet diameter 1.2 thickness 0.4",
                                     more="orientation 1 0.5 0.3") +
                scenes.make_points(((1.5, 3.0, 3.0), (5.9, 3.0, 1.0)), "seeds") + scenes.STYLES)

    def make_fix(self, more, timestep):
        return scenes.make_fix("wall walls cells stiff viscosity/ratio 5 cells soft "
                               "rigid plates force 0.3 0 0.1 tracers seeds", "mean 0.5 0.2 0",
                               timestep=timestep, more=f"{TIGHT} {more}")

    def test_ranks_and_restarts(self):
        self.check_ranks_and_restarts(["ab2", "rkc2", "error", "multirate"])

    def test_split_runs(self):
        self.check_split(["multirate"])


class Particles(Scene):
    """A cell of ratio 5 and two rigid particles in a box that flips."""

    STYLES_AGAIN = scenes.STYLES

    def make_scene(self, skin):
        return (scenes.make_header(tilt=2.9, skin=skin) +
                scenes.make_body("sphere", (0.3, 1.5, 1.6), "stiff") +
                scenes.make_particle((5.6, 1.7, 4.4), "balls") +
                scenes.make_particle((2.9, 4.3, 5.9), "balls",
                                     "platelet diameter 1.5 thickness 0.5",
                                     more="orientation 1 0.5 0.3") + scenes.STYLES)

    def make_fix(self, more, timestep):
        return scenes.make_fix("cells stiff viscosity/ratio 5 rigid balls", "shear xz 1.0",
                               timestep=timestep, more=f"{TIGHT} {more}")

    def test_ranks_and_restarts(self):
        self.check_ranks_and_restarts(["euler", "rkc2", "multirate error"])


class Clock(CellScene):
    """Steps of different lengths."""

    MORE = "error/tolerance 2e-3"

    def check_clock(self, rows, start=0.0, time_before=0.0):
        """time_before: LAMMPS' time starts anew with a restart, that of the fix does not."""
        time = start
        for row in rows[1:]:
            time += row["Dt"]
            self.assertAlmostEqual(row["f_b[28]"], time, delta=1e-12)
            self.assertAlmostEqual(row["Time"], time - time_before, delta=1e-12)
            self.assertAlmostEqual(row["f_b[5]"], time, delta=1e-11)    # strain at rate 1
            self.assertLess(row["f_b[29]"], 2e-3)

    def test_time_follows_the_steps(self):
        self.trajectory(self.MORE, 0.2, "run 8\n")
        rows = list(self.rows.values())
        self.check_clock(rows)
        lengths = [row["Dt"] for row in rows[1:]]
        self.assertLess(max(lengths), 0.2)
        self.assertGreater(max(lengths), 1.2 * min(lengths))
        tilt = 2.9 + 6.0 * rows[-1]["f_b[28]"]
        self.assertAlmostEqual(rows[-1]["Xz"], tilt - 6.0 * round(tilt / 6.0), delta=1e-10)

    def test_time_after_a_restart(self):
        self.trajectory(self.MORE, 0.2, "run 5\nwrite_restart middle\n")
        before = self.rows[5]["f_b[28]"]
        self.restarted("middle", self.MORE, 0.2, "run 4\n")
        rows = list(self.rows.values())
        self.assertEqual(rows[0]["f_b[28]"], before)
        self.check_clock(rows, before, before - rows[0]["Time"])

    def test_a_changed_timestep_is_a_new_maximum(self):
        self.trajectory(self.MORE, 0.2, "run 4\ntimestep 0.01\nrun 3\ntimestep 0.2\nrun 6\n")
        lengths = [self.rows[step]["Dt"] for step in range(1, 14)]
        self.assertGreater(min(lengths[:4]), 0.011)
        np.testing.assert_allclose(lengths[4:7], 0.01, rtol=1e-14)
        self.assertGreater(lengths[-1], 0.03)
        self.assertLess(max(lengths), 0.2)
        self.check_clock([self.rows[step] for step in range(14)])

    def test_smaller_tolerance_gives_smaller_steps(self):
        """The error of a step is of third order."""
        lengths = []
        for tolerance in (4e-3, 5e-4):
            self.trajectory(f"error/tolerance {tolerance!r}", 0.2, "run 10\n")
            lengths.append(self.rows[10]["f_b[28]"] / 10.0)
        self.assertGreater(lengths[0] / lengths[1], 1.5)
        self.assertLess(lengths[0] / lengths[1], 2.7)

    def test_halt_at_a_time(self):
        self.trajectory(self.MORE, 0.2, "variable t equal f_b[28]\n"
                        "fix end all halt 1 v_t >= 0.5 error continue\nrun 1000\n")
        last = max(self.rows)
        self.assertGreaterEqual(self.rows[last]["f_b[28]"], 0.5)
        self.assertLess(self.rows[last - 1]["f_b[28]"], 0.5)


class Closing(flow.FlowCase):
    """Two spheres pushed against each other: no step brings them through each other."""

    GAP = 0.4

    def make_pushed(self, force, timestep, n_steps, more=""):
        sphere, _ = cases.make_icosphere()
        self.write((sphere + (2.5, 2.4, 1.6), sphere),
                   (sphere + (2.5, 2.4, 3.6 + self.GAP), sphere), box=(5.0, 5.0, 6.0))
        push = ("group lower molecule 1\ngroup upper molecule 2\n"
                f"fix up lower addforce 0 0 {force!r}\nfix down upper addforce 0 0 {-force!r}\n")
        return flow.make_script(
            self.data, flow.make_styles(shear=5.0, dilatation=20.0, bending=0.05), push,
            flow.make_flow("none", timestep=timestep, more=more), flow.make_dump("closing.txt"),
            "thermo_style custom step dt f_b[26] f_b[30]\nthermo_modify format float %.15g\n"
            f"thermo 1\nrun {n_steps}\n")

    def find_gaps(self):
        """Along z, of the frames."""
        frames = flow.read_dump(self.folder / "closing.txt")
        n = len(frames[0]) // 2
        return np.array([rows[n:, 2].min() - rows[:n, 2].max()
                         for _, rows in sorted(frames.items())])

    def test_steps_are_split(self):
        """A step closes a gap of 0.4 more than twice, as the first velocities have it."""
        script = self.make_pushed(0.1, 2.0, 4)
        for n_ranks in (1, 2):
            output = flow.run(script, self.folder, n_ranks)
            n_parts = cases.read_thermo(output)[-1]["f_b[30]"]
            self.assertGreater(n_parts, 2)
            self.assertIn(f"{n_parts:.0f} additional parts of steps in which surfaces approached",
                          output)
            gaps = self.find_gaps()
            self.assertLess(gaps[1], 0.8 * self.GAP)
            self.assertGreater(gaps.min(), 0.02)

    def test_slow_surfaces_split_nothing(self):
        output = flow.run(self.make_pushed(0.1, 0.2, 4), self.folder)
        self.assertNotIn("additional parts", output)
        self.assertEqual(cases.read_thermo(output)[-1]["f_b[30]"], 0.0)

    def test_steps_by_an_error_are_shortened(self):
        """With an error that allows any step; at most half of the gap in each."""
        output = flow.run(self.make_pushed(0.1, 2.0, 6, "error/tolerance 1e6"), self.folder)
        self.assertLess(max(row["Dt"] for row in cases.read_thermo(output)[1:]), 2.0)
        gaps = self.find_gaps()
        self.assertTrue(np.all(gaps[1:] > 0.4 * gaps[:-1]), gaps)

    def test_far_too_large_steps_are_refused(self):
        script = self.make_pushed(10.0, 2.0, 4)
        for n_ranks in (1, 2):
            self.expect_error(script, "step 1", "surfaces would jump through each other",
                              "smaller timestep", "restart.biem.0", n_ranks=n_ranks)


if __name__ == "__main__":
    unittest.main()
