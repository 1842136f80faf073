"""Bad input of those keywords of fix biem that say how to step in time and what to watch, and
timesteps that are too large."""

import unittest

import flow_cases as flow
from styles import test_fix_biem_input as given


class Arguments(given.InputCase):
    def test_steps(self):
        good = "viscosity 1 accuracy 1e-3 flow none "
        self.expect_argument_errors([
            (good + "error/tolerance 0", ("error/tolerance 0 must be a positive number",)),
            (good + "error/tolerance -1e-3", ("error/tolerance -1e-3 must be a positive number",)),
            (good + "error/tolerance 1e400", ("1e400",)),
            (good + "error/tolerance small", ("'small'",)),
            (good + "error/tolerance", ("'error/tolerance' ends too early",)),
            (good + "error/tolerance 1e-3 error/tolerance 1e-3",
             ("keyword 'error/tolerance' is given twice",)),
            (good + "stepper ab2 error/tolerance 1e-3", ("error/tolerance", "stepper rkc2")),
            (good + "multirate yes stepper euler", ("multirate", "stepper rkc2")),
            (good + "multirate maybe", ("multirate maybe", "yes or no")),
            (good + "multirate", ("'multirate' ends too early",)),
            (good + "multirate no multirate yes", ("keyword 'multirate' is given twice",)),
            (good + "hold shape", ("cannot hold 'shape'", "none", "volume", "area")),
            (good + "hold", ("'hold' ends too early",)),
            (good + "hold none hold area", ("keyword 'hold' is given twice",))])

    def test_watch(self):
        good = "viscosity 1 accuracy 1e-3 flow none watch"
        self.expect_argument_errors([
            (good, ("keyword 'watch' needs off, or any of: edge ratio, area ratio, crossings",)),
            (good + " nothing", ("keyword 'watch' needs off",)),
            (good + " edge", ("'watch edge' ends too early",)),
            (good + " edge 1", ("watch edge 1", "larger than 1")),
            (good + " edge -2", ("watch edge -2", "larger than 1")),
            (good + " edge 1e400", ("1e400",)),
            (good + " edge long", ("'long'",)),
            (good + " edge 2 area 0.5", ("watch area 0.5", "larger than 1")),
            (good + " area 2 crossings -1", ("crossings -1 is out of range",)),
            (good + " crossings 1.5", ("'1.5'",)),
            (good + " off edge 2", ("unknown keyword 'edge'",)),
            (good + " off watch off", ("keyword 'watch' is given twice",))])


class Timesteps(given.InputCase):
    def test_timestep_beyond_stability(self):
        for stepper in ("ab2", "euler"):
            for n_ranks in (1, 2):
                fix = flow.make_flow(timestep=0.05, more=f"stepper {stepper}")
                self.expect_error(self.script(fix, end="run 1000\n"), "step 1", "timestep 0.05",
                                  "limit of stability", "stepper rkc2", n_ranks=n_ranks,
                                  is_kept=False)

    def test_timestep_far_too_large(self):
        """Stable with enough stages, but nodes move by more than a triangle."""
        push = "group one molecule 1\nfix push one addforce 0.0 0.3 0.0\n"
        fix = flow.make_flow("none", timestep=200.0)
        self.expect_error(self.script(fix, push, end="run 3\n"), "timestep|stretched", "step 1",
                          is_kept=False)


if __name__ == "__main__":
    unittest.main()
