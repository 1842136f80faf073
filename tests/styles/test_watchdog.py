"""Runs that go wrong stop with an error that names the cell and says what to change, and leave a
restart file from which a second run goes on."""

import unittest

import numpy as np

import coupled_cases as scenes
import flow_cases as flow
from styles import membrane_cases as cases

BOX = (5.0, 5.0, 6.0)
CENTER = (2.5, 2.4, 3.1)


class Case(flow.FlowCase):
    def write_spheres(self, *centers):
        sphere, _ = cases.make_icosphere()
        self.write(*((sphere + center, sphere) for center in centers), box=BOX)

    def script(self, n_steps, forces="", more="", styles=None, **options):
        return flow.make_script(self.data, styles or flow.make_styles(), forces,
                                flow.make_flow(more=more, **options), f"run {n_steps}\n")

    def stop(self, script, *parts, n_ranks=1):
        """The run stops with these parts in its message; the step of the one restart file."""
        for old in self.folder.glob("restart.biem.*"):
            old.unlink()
        self.expect_error(script, *parts, "restart.biem.", n_ranks=n_ranks)
        files = list(self.folder.glob("restart.biem.*"))
        self.assertEqual(len(files), 1, files)
        return int(files[0].name.rsplit(".", 1)[1])

    def go_on(self, step, n_steps, forces="", more="", **options):
        """Thermo rows of a second run, from the restart file of the first."""
        script = (f"read_restart restart.biem.{step}\nneighbor 0.2 bin\npair_style none\n" +
                  forces + flow.make_flow(more=more, **options) +
                  "thermo_style custom step vol f_b[1]\nthermo_modify format float %.15g\n" +
                  f"run {n_steps}\n")
        rows = cases.read_thermo(flow.run(script, self.folder))
        self.assertEqual(rows[0]["Step"], step)
        self.assertEqual(rows[-1]["Step"], step + n_steps)
        return rows


class OneCell(Case):
    def setUp(self):
        super().setUp()
        self.write_spheres(CENTER)

    def test_force_without_bound(self):
        push = "variable f equal (step>4)*1e300\nfix push all addforce v_f 0.0 0.0\n"
        step = self.stop(self.script(20, push), "cell 1|molecule 1", "smaller timestep")
        self.assertLessEqual(step, 5)
        self.go_on(step, 3)

    def test_timestep_beyond_stability(self):
        """Of the steppers of one evaluation, which the error knows beforehand."""
        for stepper in ("ab2", "euler"):
            more = f"stepper {stepper}"
            step = self.stop(self.script(400, more=more, timestep=0.03), "step 1",
                             "timestep 0.03 is beyond the limit of stability", "spectral radius",
                             "use a smaller one, or stepper rkc2")
            self.assertEqual(step, 0)
            self.go_on(step, 5, more=more, timestep=0.002)
            self.go_on(step, 5, timestep=0.03)

    def test_edge_beyond_the_limit(self):
        soft = flow.make_styles(shear=0.5, dilatation=1.0)
        for n_ranks in (1, 2):
            step = self.stop(self.script(400, more="watch edge 1.1", styles=soft, timestep=0.01),
                             "cell 1", "edge", "limits 0.9091 and 1.1", "too soft", "watch edge",
                             n_ranks=n_ranks)
            self.assertGreater(step, 3)
            self.go_on(step, 5, more="watch edge 1.3", timestep=0.01)

    def test_area_beyond_the_limit(self):
        soft = flow.make_styles(shear=0.5, dilatation=1.0)
        step = self.stop(self.script(400, more="watch area 1.05", styles=soft, timestep=0.01),
                         "cell 1", "area", "limits 0.9524 and 1.05", "too soft", "watch area")
        self.go_on(step, 5, more="watch off", timestep=0.01)

    def test_two_neighbors_pulled_past_each_other(self):
        sphere, triangles = cases.make_icosphere()
        one, two = triangles[40][:2]
        pull = f"group one id {one + 1}\ngroup two id {two + 1}\n"
        force = 8.0 * (sphere[two] - sphere[one]) / np.linalg.norm(sphere[two] - sphere[one])
        for name, f in (("one", force), ("two", -force)):
            pull += f"fix {name} {name} addforce {f[0]!r} {f[1]!r} {f[2]!r}\n"
        soft = flow.make_styles(shear=1.0, dilatation=1.0, bending=1e-4)
        script = self.script(500, pull, "watch edge 100 area 100", soft, flow="none",
                             timestep=0.002)
        step = self.stop(script, "cell 1", "folded|collapsed", "smaller timestep")
        self.go_on(step, 5, more="watch edge 100 area 100", timestep=0.002)

    def test_error_that_no_step_can_meet(self):
        more = "error/tolerance {}"
        step = self.stop(self.script(5, more=more.format("1e-14"), timestep=0.1), "step 1",
                         "no step down to 0.0001 of the timestep", "error/tolerance 1e-14",
                         "allow a larger error")
        self.assertEqual(step, 0)
        self.go_on(step, 3, more=more.format("1e-3"), timestep=0.1)

    def test_steps_by_an_error_stop_as_well(self):
        soft = flow.make_styles(shear=0.5, dilatation=1.0)
        more = "error/tolerance 1e-3 watch edge {}"
        for n_ranks in (1, 2):
            step = self.stop(self.script(400, more=more.format(1.1), styles=soft, timestep=0.1),
                             "cell 1", "edge", "limits 0.9091 and 1.1", n_ranks=n_ranks)
            self.assertGreater(step, 1)
            rows = self.go_on(step, 5, more=more.format(1.3), timestep=0.1)
            self.assertEqual(rows[-1]["Volume"], 150.0)

    def test_timestep_that_needs_too_many_stages(self):
        step = self.stop(self.script(5, flow="none", timestep=1000.0), "step 1",
                         "needs more than 200 stages", "smaller timestep")
        self.assertEqual(step, 0)
        self.go_on(step, 2, flow="none", timestep=0.1)

    def test_nothing_is_reported_where_nothing_is_wrong(self):
        rows = cases.run_thermo(self.script(20, timestep=0.004), self.folder)
        self.assertEqual(rows[-1]["Step"], 20)
        self.assertEqual(list(self.folder.glob("restart.biem.*")), [])


class TwoCells(Case):
    def test_node_pulled_into_another_cell(self):
        sphere, _ = cases.make_icosphere()
        top = int(np.argmax(sphere[:, 2])) + 1
        self.write_spheres((2.5, 2.4, 1.5), (2.5, 2.4, 3.55))
        pull = f"group one id {top}\nfix up one addforce 0.0 0.0 20.0\n"
        script = self.script(200, pull, "stepper ab2 watch edge 100 area 100",
                             flow.make_styles(shear=5.0, dilatation=20.0), flow="none",
                             timestep=0.002)
        for n_ranks in (1, 2):
            step = self.stop(script, "cell 1 and cell 2", "gone through each other",
                             "smaller timestep", n_ranks=n_ranks)
            self.go_on(step, 5, timestep=0.002)

    def test_crossings_are_looked_for_where_asked_for(self):
        """In every fourth step, or not at all."""
        sphere, _ = cases.make_icosphere()
        top = int(np.argmax(sphere[:, 2])) + 1
        self.write_spheres((2.5, 2.4, 1.5), (2.5, 2.4, 3.55))
        pull = f"group one id {top}\nfix up one addforce 0.0 0.0 20.0\n"

        def make(n_steps, crossings):
            more = f"stepper ab2 watch edge 100 area 100 crossings {crossings}"
            return self.script(n_steps, pull, more, flow.make_styles(shear=5.0, dilatation=20.0),
                               flow="none", timestep=0.002)

        first = self.stop(make(200, 1), "gone through each other")
        later = self.stop(make(200, 4), "gone through each other")
        self.assertEqual((later + 1) % 4, 0)
        self.assertLess(abs(later - first), 5)
        rows = cases.run_thermo(make(first + 3, 0), self.folder)
        self.assertEqual(rows[-1]["Step"], first + 3)


class CellAndWall(flow.FlowCase):
    def test_cell_pressed_through_a_wall(self):
        more = "stepper euler hold none watch edge 100 area 100"
        script = (scenes.make_header() + scenes.make_wall() +
                  scenes.make_body("sphere", (3.0, 2.9, 1.3), "cell", nodes=162) + scenes.STYLES +
                  "fix down cell addforce 0 0 -2.0\n" +
                  scenes.make_fix("wall walls cells cell", timestep=0.02, more=more) +
                  "run 100\n")
        self.expect_error(script, "wall 1", "cell 2", "gone through each other",
                          "pair_style biem/contact", "restart.biem.")
        file, = self.folder.glob("restart.biem.*")
        again = (f"read_restart {file.name}\n" + scenes.STYLES +
                 scenes.make_fix("wall walls cells cell", timestep=0.002, more="hold none") +
                 "run 3\n")
        flow.run(again, self.folder)


if __name__ == "__main__":
    unittest.main()
