"""The sheared, flipping box: points follow the flow exactly over many flips, a flip changes no
velocity, and `rerun` gives the velocities of the run."""

import unittest

import numpy as np

import flow_cases as flow
from styles import membrane_cases as cases

EXACT = 1e-10
LENGTHS = (6.0, 5.0, 4.0)


def make_points(tilt, lengths=LENGTHS, n=60):
    """Commands: a tilted box with points and nothing else."""
    return (flow.make_header() +
            f"region box prism 0 {lengths[0]} 0 {lengths[1]} 0 {lengths[2]} "
            f"{tilt[0]} {tilt[1]} {tilt[2]}\n"
            "create_box 1 box\npair_style none\nmass * 1.0\n"
            f"create_atoms 1 random {n} 4321 box\n"
            # copies of the box above and below, whose points move faster and slower
            "group up id 1:10\nset group up image NULL NULL 1\n"
            "group down id 11:20\nset group down image NULL NULL -2\n")


class Points(flow.FlowCase):
    """Without cells the disturbance vanishes: x = x0 + rate z0 t exactly."""

    def check(self, script, rate, timestep, n_flips, n_ranks):
        output = flow.run(script, self.folder, n_ranks)
        frames = flow.read_dump(self.folder / "points.txt")
        first, last = frames[min(frames)], max(frames)
        self.assertGreater(len(first), 10)
        for step, rows in frames.items():
            expected = np.array(first[:, :3])
            expected[:, 0] += rate * first[:, 2] * timestep * step
            np.testing.assert_allclose(rows[:, :3], expected, rtol=0.0, atol=EXACT)
            inside = first[:, 2] - LENGTHS[2] * np.floor(first[:, 2] / LENGTHS[2])
            np.testing.assert_allclose(rows[:, 3], rate * inside, rtol=0.0, atol=EXACT)
            np.testing.assert_allclose(rows[:, 4:], 0.0, atol=EXACT)
        table = [line.split() for line in output.splitlines()]
        self.assertIn([str(last), str(n_flips)], table)

    def test_points_over_many_flips(self):
        # rate * Lz / Lx * 200 * 0.1 = 13.3 box lengths
        for rate, tilt, n_flips in ((1.0, (0, 0, 0), 13), (-1.0, (0, 2.5, 0), 13),
                                    (1.0, (1.5, -2.0, -1.0), 13)):
            for n_ranks in (1, 4):
                with self.subTest(rate=rate, tilt=tilt, n_ranks=n_ranks):
                    script = (make_points(tilt) + "group points union all\n" +
                              flow.make_flow(f"shear xz {rate}", timestep=0.1,
                                             more="tracers points") +
                              flow.make_dump("points.txt", 20) +
                              "thermo_style custom step f_b[6]\nrun 200\n")
                    self.check(script, rate, 0.1, n_flips, n_ranks)

    def test_large_steps_flip_often(self):
        """0.45 box lengths a step: a flip in about every second step."""
        script = (make_points((0, 0, 0)) + "group points union all\n" +
                  flow.make_flow("shear xz 1.0", timestep=0.675, more="tracers points") +
                  flow.make_dump("points.txt", 5) + "thermo_style custom step f_b[6]\nrun 40\n")
        for n_ranks in (1, 4):
            self.check(script, 1.0, 0.675, 18, n_ranks)

    def test_a_step_of_more_than_half_a_box_is_refused(self):
        script = (make_points((0, 0, 0)) + "group points union all\n" +
                  flow.make_flow("shear xz 1.0", timestep=0.76, more="tracers points") + "run 1\n")
        result = cases.run(script, self.folder)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("Fix biem: timestep 0.76", result.stdout)
        self.assertIn("more than half", result.stdout)

    def test_mean_flow(self):
        script = (make_points((0, 1.0, 0)) + "group points union all\n" +
                  flow.make_flow("mean 1.0 -2.0 0.5", timestep=0.1, more="tracers points") +
                  flow.make_dump("points.txt", 20) + "run 100\n")
        for n_ranks in (1, 4):
            flow.run(script, self.folder, n_ranks)
            frames = flow.read_dump(self.folder / "points.txt")
            for step, rows in frames.items():
                moved = frames[0][:, :3] + 0.1 * step * np.array([1.0, -2.0, 0.5])
                np.testing.assert_allclose(rows[:, :3], moved, rtol=0.0, atol=EXACT)


class Flip(flow.FlowCase):
    def write_deformed(self, tilt):
        self.write(flow.make_red_cell((0.1, 5.9, 0.05), 30.0, (1.1, 0.9, 1.05)),
                   flow.make_red_cell((3.0, 2.9, 5.8), 80.0), tilt=(0.0, tilt, 0.0))

    def velocities(self, tilt, n_ranks=1, accuracy=1e-3):
        self.write_deformed(tilt)
        script = flow.make_script(self.data, flow.make_styles(), flow.make_flow(accuracy=accuracy),
                                  flow.make_dump("one.txt"), "run 0\n")
        flow.run(script, self.folder, n_ranks)
        return flow.read_dump(self.folder / "one.txt")[0]

    def test_two_tilts_of_one_lattice(self):
        for n_ranks in (1, 4):
            before, after = self.velocities(3.0, n_ranks), self.velocities(-3.0, n_ranks)
            size = np.abs(before[:, 6:9]).max()
            self.assertGreater(size, 0.1)
            np.testing.assert_allclose(after[:, :3], before[:, :3], rtol=0.0, atol=EXACT)
            np.testing.assert_allclose(after[:, 6:9], before[:, 6:9], rtol=0.0, atol=EXACT)

    def test_the_flip_of_a_run(self):
        """Velocities across the flip change as smoothly as before it: second differences."""
        self.write_deformed(2.9)
        script = flow.make_script(self.data, flow.make_styles(),
                                  flow.make_flow(accuracy=1e-6, timestep=2e-3),
                                  flow.make_dump("run.txt"),
                                  "thermo_style custom step xz\nthermo 1\nrun 18\n")
        output = flow.run(script, self.folder)
        tilts = [row["Xz"] for row in cases.read_thermo(output)]
        flips = [k for k in range(1, 19) if tilts[k] < tilts[k - 1]]
        self.assertEqual(flips, [9])
        frames = flow.read_dump(self.folder / "run.txt")
        u = np.array([frames[k][:, 6:9] for k in range(19)])
        change = np.abs(u[2:] - 2.0 * u[1:-1] + u[:-2]).max(axis=(1, 2))
        self.assertLess(change[7:9].max(), 1.5 * np.delete(change, [7, 8])[4:].max())


class Rerun(flow.FlowCase):
    def test_rerun_gives_the_velocities_of_the_run(self):
        self.write(flow.make_red_cell((0.1, 5.9, 0.05), 30.0),
                   flow.make_red_cell((3.0, 2.9, 5.8), 80.0), tilt=(0.0, 2.9, 0.0))
        for kind, timestep, n_steps, more in (
                ("none", 0.1, 4, ""), ("mean 0.3 -0.2 0.5", 0.004, 30, "stepper ab2"),
                ("shear xz 1.0", 0.1, 4, ""), ("shear xz 1.0", 0.1, 4, "multirate yes"),
                ("shear xz 1.0", 0.004, 30, "stepper euler")):
            every = n_steps // 2
            parts = (flow.make_styles(), flow.make_flow(kind, timestep=timestep, more=more))
            script = flow.make_script(self.data, *parts, flow.make_dump("run.txt", every),
                                      f"run {n_steps}\n")
            flow.run(script, self.folder)
            first = flow.read_dump(self.folder / "run.txt")
            again = flow.make_script(
                self.data, *parts, flow.make_dump("rerun.txt", every),
                "rerun run.txt dump x y z box yes scaled no wrapped no\n")
            for n_ranks in (1, 2):
                with self.subTest(kind=kind, more=more, n_ranks=n_ranks):
                    flow.run(again, self.folder, n_ranks)
                    second = flow.read_dump(self.folder / "rerun.txt")
                    self.assertEqual(sorted(second), [0, every, 2 * every])
                    self.assert_same_frames(first, second, EXACT)


if __name__ == "__main__":
    unittest.main()
