"""The number of ranks, their layout and load balancing do not change a trajectory: cells across
the faces and a corner of a sheared box that flips, and tracers."""

import unittest

import numpy as np

import flow_cases as flow

TOLERANCE = 1e-10
N_STEPS = 8
TIMESTEP = 0.05

# The first cell holds a corner of the box, the second crosses a face, the third is inside.
CELLS = (((0.1, 5.9, 0.05), 30.0), ((3.0, 2.9, 5.8), 80.0), ((3.1, 3.0, 2.8), 10.0))


class Ranks(flow.FlowCase):
    def setUp(self):
        super().setUp()
        # the tilt passes 3, half a box length, in the first step: one flip
        self.write(*(flow.make_red_cell(*cell) for cell in CELLS), tilt=(0.0, 2.9, 0.0))
        self.reference = self.trajectory(1)

    def trajectory(self, n_ranks, before="", after="", more=""):
        """Frames of a run; before: commands ahead of the box, after: behind fix biem."""
        file = self.folder / "trajectory.txt"
        script = before + flow.make_script(
            self.data, flow.make_styles(), flow.make_flow(timestep=TIMESTEP, more=more), after,
            flow.make_dump(file, 2), f"thermo_style custom step f_b[6]\nrun {N_STEPS}\n")
        self.output = flow.run(script, self.folder, n_ranks)
        return flow.read_dump(file)

    def test_the_case_moves_and_flips(self):
        first, last = self.reference[0], self.reference[N_STEPS]
        self.assertGreater(np.abs(last - first)[:, :3].max(), 0.5)
        self.assertGreater(np.abs(last[:, 6:9]).max(), 0.1)
        rows = [line.split() for line in self.output.splitlines()]
        self.assertIn([str(N_STEPS), "1"], rows)

    def test_numbers_of_ranks(self):
        for n_ranks in (2, 3, 4):
            with self.subTest(n_ranks=n_ranks):
                self.assert_same_frames(self.reference, self.trajectory(n_ranks), TOLERANCE)

    def test_layouts_of_ranks(self):
        for layout in ("4 1 1", "1 1 4", "1 2 2"):
            with self.subTest(layout=layout):
                other = self.trajectory(4, before=f"processors {layout}\n")
                self.assert_same_frames(self.reference, other, TOLERANCE)

    def test_ranks_without_atoms(self):
        self.write(flow.make_red_cell((2.0, 2.1, 2.2)), box=(20.0, 20.0, 20.0))
        one, other = (self.trajectory(n) for n in (1, 4))
        self.assert_same_frames(one, other, TOLERANCE)

    def test_balanced_ranks(self):
        for name, before, after in (
                ("shift", "", "fix l all balance 2 1.0 shift xz 10 1.01\n"),
                ("rcb", "comm_style tiled\n", "fix l all balance 2 1.0 rcb\n")):
            with self.subTest(name=name):
                self.assert_same_frames(self.reference, self.trajectory(4, before, after),
                                        TOLERANCE)

    def test_consistent_traction(self):
        one, other = (self.trajectory(n, more="traction consistent") for n in (1, 4))
        self.assertGreater(np.abs(one[0][:, 6:9] - self.reference[0][:, 6:9]).max(), 1e-6)
        self.assert_same_frames(one, other, TOLERANCE)

    def test_other_split(self):
        one, other = (self.trajectory(n, more="ewald spme") for n in (1, 4))
        difference = np.abs(one[0][:, 6:9] - self.reference[0][:, 6:9]).max()
        self.assertGreater(difference, 1e-8)
        self.assertLess(difference, 1e-3)    # the accuracy of both sums, velocities of order 1
        self.assert_same_frames(one, other, TOLERANCE)

    def test_tuning_by_search_keeps_the_accuracy(self):
        tuned = self.trajectory(2, more="tune search")
        self.assertIn("tuned on this machine", self.output)
        difference = np.abs(tuned[0][:, 6:9] - self.reference[0][:, 6:9]).max()
        self.assertLess(difference, 1e-3)    # the accuracy, velocities of order 1

    def test_cells_with_tracers(self):
        tracers = ("lattice sc 1.2 origin 0.3 0.4 0.2\nregion r block INF INF INF INF INF INF\n"
                   "group nodes molecule > 0\ncreate_atoms 1 region r\n"
                   "group points subtract all nodes\n")
        frames = []
        for n_ranks in (1, 2, 4):
            file = self.folder / "trajectory.txt"
            script = flow.make_script(
                self.data, tracers, flow.make_styles(),
                flow.make_flow(timestep=TIMESTEP, more="tracers points cells nodes"),
                flow.make_dump(file, 2),
                f"run {N_STEPS}\n")
            flow.run(script, self.folder, n_ranks)
            # create_atoms numbers the new atoms by rank: sort the points by where they start
            frame = flow.read_dump(file)
            n_nodes = len(self.reference[0])
            start = np.round(frame[0][n_nodes:, :3], 6)
            order = np.concatenate([np.arange(n_nodes),
                                    n_nodes + np.lexsort(start.T)])
            frames.append({step: rows[order] for step, rows in frame.items()})
        self.assertGreater(len(frames[0][0]), len(self.reference[0]) + 50)
        for other in frames[1:]:
            self.assert_same_frames(frames[0], other, TOLERANCE)
        # points take no part in the flow of the cells
        nodes = {step: rows[:len(self.reference[0])] for step, rows in frames[0].items()}
        self.assert_same_frames(self.reference, nodes, 1e-3)


if __name__ == "__main__":
    unittest.main()
