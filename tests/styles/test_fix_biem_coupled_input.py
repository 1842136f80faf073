"""Bad input of scenes with rigid particles, walls and viscosity ratios stops with a message that
names the surface and the cause; what is unusual but legal works."""

import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import coupled_cases as scenes
import flow_cases as flow
from styles import membrane_cases as cases

BALL = scenes.make_particle((3, 3, 3))
CELL = scenes.make_body("sphere", (3, 3, 3), "cells")
WALL = scenes.make_wall()
RUN = "run 0\n"


class CoupledCase(cases.FolderCase):
    def script(self, bodies, surfaces, between="", end=RUN, box=(6.0, 6.0, 6.0), **options):
        """between: commands ahead of fix biem."""
        return (scenes.make_header(box) + bodies + scenes.STYLES + between +
                scenes.make_fix(surfaces, **options) + end)

    def expect_errors(self, *scripts_and_parts):
        """Many at a time: a short run of LAMMPS mostly waits for MPI to start."""
        def check(case):
            with tempfile.TemporaryDirectory(dir=self.folder) as folder:
                self.expect_error(case[0], *case[1:], folder=Path(folder))

        with ThreadPoolExecutor(4) as pool:
            checks = [(case, pool.submit(check, case)) for case in scripts_and_parts]
        for case, done in checks:
            with self.subTest(parts=case[1:]):
                done.result()

    def run_script(self, script, n_ranks=1):
        return flow.run(script, self.folder, n_ranks)


def shift(group, x=0.0, y=0.0, z=0.0):
    return f"displace_atoms {group} move {x} {y} {z} units box\n"


class Overlaps(CoupledCase):
    """Bodies of radius 1 that commands have moved into each other."""

    TWO_BALLS = BALL + scenes.make_particle((0.5, 3, 3))
    TWO_CELLS = CELL + scenes.make_body("sphere", (0.5, 3, 3), "more")
    SURFACES = "cells cells cells more"

    def test_walls(self):
        cross = "surfaces of cell 1 and wall 2 (molecule ids) cross", "enlarge the box"
        for n_ranks in (1, 2):
            self.expect_error(self.script(CELL + WALL, "cells cells wall walls",
                                          shift("cells", z=2.5)), *cross, n_ranks=n_ranks)
        self.expect_errors(
            # the other way about: through the face of the box that the wall lies in
            (self.script(CELL + WALL, "cells cells wall walls", shift("cells", z=-2.1)), *cross),
            (self.script(BALL + WALL, "rigid balls wall walls", shift("walls", z=2.5)),
             "rigid particle 1 and wall 2", "step 0"),
            # a sheet through the particle, whose nodes all lie outside
            (self.script(BALL + scenes.make_wall(edge=2.9), "rigid balls wall walls",
                         shift("balls", x=0.7, y=0.8, z=2.999)),
             "rigid particle 1 and wall 2"))

    def test_closed_surfaces(self):
        other = shift("all", x=3.1) + "group two molecule 2\n"
        self.expect_errors(
            (self.script(self.TWO_CELLS, self.SURFACES, other + shift("more", x=0.8)),
             "cell 1 and cell 2", "smaller timestep"),
            (self.script(self.TWO_BALLS, "rigid balls", other + shift("two", x=0.8)),
             "rigid particle 1 and rigid particle 2"),
            (self.script(CELL + scenes.make_particle((0.5, 3, 3)), "cells cells rigid balls",
                         shift("balls", y=1.0, x=0.8)), "cell 1 and rigid particle 2"),
            # exactly on top of each other
            (self.script(self.TWO_CELLS, self.SURFACES, shift("more", x=2.5)),
             "cell 1 and cell 2"))

    def test_one_within_the_other(self):
        small = scenes.make_particle((0.5, 3, 3), more="radius 0.3")
        seed = scenes.make_body("sphere", (0.5, 3, 3), "more", more="radius 0.3")
        into = shift("{}", x=2.6, y=0.2)
        self.expect_errors(
            (self.script(CELL + small, "cells cells rigid balls", into.format("balls")),
             "rigid particle 2 lies inside cell 1"),
            (self.script(BALL + seed, "rigid balls cells more", into.format("more")),
             "cell 2 lies inside rigid particle 1"),
            (self.script(CELL + seed, "cells cells viscosity/ratio 5 cells more",
                         into.format("more") + shift("all", x=2.9, z=-2.7)),
             "cell 2 lies inside cell 1"))
        # without unknowns nothing is wrong: a cell with a nucleus
        self.run_script(self.script(CELL + seed, self.SURFACES, into.format("more")))

    def test_surfaces_of_different_ranks(self):
        """A particle that one rank has, a large cell about the place where others see nothing."""
        small = scenes.make_particle((0.5, 3, 3), more="radius 0.3")
        apart = shift("all", x=-3, y=-3, z=-3)    # the cell about the origin
        inside = shift("balls", x=2.6, y=0.2)
        for n_ranks in (2, 4):
            self.run_script(self.script(CELL + small, "cells cells rigid balls", apart),
                            n_ranks=n_ranks)
            self.expect_error(self.script(CELL + small, "cells cells rigid balls",
                                          inside + apart),
                              "rigid particle 2 lies inside cell 1", n_ranks=n_ranks)

    def test_own_image(self):
        stretched = "displace_atoms cells ramp x -2.2 2.2 x 2 4 units box\n"
        self.expect_error(self.script(CELL, "cells cells", stretched),
                          "cell 1 and its own periodic image")

    def test_small_gaps_are_legal(self):
        """Gaps of 0.01 between a wall, a particle and a cell, and to the wall's other side."""
        bodies = (scenes.make_wall() + scenes.make_particle((3, 3, 1.2)) +
                  scenes.make_body("sphere", (3, 3, 4.7), "cells"))
        moves = ("displace_atoms balls move 0 0 $({gap}-bound(balls,zmin)) units box\n"
                 "displace_atoms cells move 0 0 $({end}) units box\n")
        for end in ("bound(balls,zmax)+{gap}-bound(cells,zmin)", "6-{gap}-bound(cells,zmax)"):
            def script(gap):
                return self.script(bodies, "wall walls rigid balls cells cells",
                                   moves.format(gap=gap, end=end.format(gap=gap)), end="")
            self.run_script(script(0.01) + RUN)
            self.expect_error(script(-0.01) + RUN, "rigid particle 2 and cell 3|wall 1 and")

    def test_cells_that_a_run_has_brought_together(self):
        """Viscosity ratio 1: a warning, so that a long run can be continued; else an error."""
        end = RUN + "displace_atoms more move 0.8 0 0 units box\n" + RUN
        output = self.run_script(self.script(self.TWO_CELLS, self.SURFACES, end=end))
        self.assertIn("WARNING: Fix biem: step 0: the surfaces of cell 1 and cell 2", output)
        self.expect_error(self.script(self.TWO_CELLS, "cells cells cells more viscosity/ratio 2",
                                      end=end), "cell 1 and cell 2")


class Arguments(CoupledCase):
    def expect(self, *arguments_and_parts, bodies=CELL + BALL.replace("3 3 3", "0.5 3 3")):
        """arguments: all of the fix but viscosity and accuracy."""
        head = scenes.make_header() + bodies + scenes.STYLES
        head += "timestep 0.01\nfix b all biem viscosity 1 accuracy 1e-3 "
        self.expect_errors(*((head + case[0] + "\n" + RUN, *case[1:])
                             for case in arguments_and_parts))

    def test_numbers(self):
        self.expect(
            ("flow none cells cells viscosity/ratio 0 rigid balls", "viscosity/ratio 0 must be"),
            ("flow none cells cells viscosity/ratio -2 rigid balls", "viscosity/ratio -2 must be"),
            ("flow none cells cells viscosity/ratio nan rigid balls", "'nan'"),
            ("flow none cells cells rigid balls force 0 nan 0", "'nan'"),
            ("flow none cells cells rigid balls force 0 1e400 0", "1e400"),
            ("flow none cells cells rigid balls torque 0 0", "'rigid torque' ends too early"),
            ("flow none cells cells wall balls velocity 1 0", "'wall velocity' ends too early"),
            ("flow pressure/drop 1 nan 0", "'nan'"), ("flow pressure/drop 1 0", "ends too early"),
            ("flow none solver/tolerance 0", "solver/tolerance 0 must be a positive number"),
            ("flow none solver/tolerance 1", "solver/tolerance 1 is out of range", "less than 1"),
            ("flow none solver/tolerance 1e-17", "solver/tolerance 1e-17 is out of range", "1e-14"),
            ("flow none solver/tolerance x", "'x'"),
            ("flow none solver/iterations 0", "solver/iterations 0 is out of range"),
            ("flow none solver/iterations 2.5", "'2.5'"))

    def test_words(self):
        self.expect(
            ("flow mean 1 0 0 flow pressure/drop 1 0 0", "'flow' is given twice", "in one way"),
            ("flow none cells nothing", "group 'nothing' after keyword 'cells' does not exist"),
            ("flow none rigid nothing", "group 'nothing' after keyword 'rigid' does not exist"),
            ("flow none wall nothing", "group 'nothing' after keyword 'wall' does not exist"),
            ("flow none probes nothing", "group 'nothing' after keyword 'probes' does not exist"),
            ("flow none cells cells rigid cells", "group 'cells' is named twice"),
            ("flow none cells cells tracers cells", "group 'cells' is named twice"),
            ("flow none viscosity/ratio 5 cells cells rigid balls",
             "viscosity/ratio stands alone, but cells are named", "cells <group> viscosity/ratio"),
            ("flow none cells cells rigid balls velocity 1 0 0", "unknown keyword 'velocity'"),
            ("flow none cells cells probes balls probes balls", "'probes' is given twice"))

    def test_flows_against_walls(self):
        closed, bodies = "cells cells rigid balls wall walls", WALL + CELL
        bodies += scenes.make_particle((0.5, 3, 3))
        self.expect(
            ("flow pressure/drop 1 0 0 cells cells rigid balls", "pressure drop", "has none",
             "mean velocity"))
        self.expect(
            ("flow mean 0 0 0.1 " + closed, "mean velocity 0.1", "along z", "closed wall"),
            ("flow pressure/drop 1 0 0.1 " + closed, "pressure drop 0.1", "along z", "closed wall"),
            ("flow none " + closed + " velocity 0 0 0.2", "wall velocity 0.2", "along z"),
            ("flow shear xz 1 " + closed, "shear", "walls that move"), bodies=bodies)


class Groups(CoupledCase):
    TWO = CELL + scenes.make_particle((0.5, 3, 3))

    def test_overlaps(self):
        both = "group both union cells balls\n"
        self.expect_errors(
            (self.script(self.TWO, "cells both rigid balls", both), "atom 43", "two of the groups",
             "must not overlap"),
            (self.script(self.TWO, "cells cells rigid balls tracers both", both), "atom 1",
             "two of the groups"),
            (self.script(self.TWO, "cells cells"), "atom 43", "in none of the groups"),
            (self.script(self.TWO, "cells half rigid other", "group half id 1:20\n"
                         "group other subtract all half\n"), "molecule 1",
             "different groups of fix biem"))

    def test_points_and_triangles(self):
        points = scenes.make_points(((0.5, 0.5, 0.5),))
        push = "fix push points addforce 1 0 0\n"
        wall_push = push.replace("points", "walls")
        self.expect_errors(
            (self.script(self.TWO, "cells cells tracers balls"), "atom 43", "vertex of a triangle"),
            (self.script(self.TWO, "cells cells probes balls"), "atom 43", "vertex of a triangle"),
            (self.script(CELL + points, "cells cells rigid points", "set atom 43 mol 2\n"),
             "atom 43", "rigid particle", "in no triangle"),
            (self.script(CELL + points, "cells cells tracers points", push), "atom 43",
             "only follow the flow"),
            (self.script(CELL + points, "cells cells probes points", push), "atom 43",
             "only follow the flow"),
            (self.script(WALL + CELL, "cells cells wall walls", wall_push), "walls do not move",
             "angle type without forces"))

    def test_open_surface_as_a_particle(self):
        nodes, triangles = cases.make_icosphere(1)
        (self.folder / "open.off").write_text("\n".join(
            [f"OFF\n{len(nodes)} {len(triangles) - 1} 0"] +
            [" ".join(map(str, x + 3.0)) for x in nodes] +
            ["3 " + " ".join(map(str, t)) for t in triangles[:-1]]) + "\n")
        cup = "create_wall mesh open.off group cup type 2 angle_type 2\n"
        for surfaces, kind in (("rigid cup", "rigid particle"), ("cells cup", "cell")):
            self.expect_error(self.script(cup, surfaces), "molecule 1 is open",
                              kind + " must be closed")
        self.run_script(self.script(cup, "wall cup"))    # an open wall is legal

    def test_empty_groups_are_nothing(self):
        output = self.run_script(self.script(
            CELL, "cells cells viscosity/ratio 2 rigid none wall nowall tracers none2 probes none3",
            "group none empty\ngroup nowall empty\ngroup none2 empty\ngroup none3 empty\n"))
        self.assertNotIn("rigid particles", output)

    def test_angle_style(self):
        none = scenes.STYLES.split("angle_style")[0] + "angle_style none\ndihedral_style none\n"
        script = self.script(BALL, "rigid balls")
        self.expect_error(script.replace(scenes.STYLES, none), "need an angle style",
                          "angle_style zero")
        zero = none.replace("angle_style none", "angle_style zero\nangle_coeff *")
        self.run_script(script.replace(scenes.STYLES, zero))


class Solver(CoupledCase):
    def test_no_convergence(self):
        bodies = scenes.make_wall() + scenes.make_particle((3, 3, 1.2)) + scenes.make_body(
            "sphere", (3, 3, 4.7), "cells")
        surfaces = "wall walls rigid balls force 1 0 0 cells cells viscosity/ratio 50"
        for n_ranks in (1, 2):
            self.expect_error(
                self.script(bodies, surfaces, more="solver/iterations 1 solver/tolerance 1e-10"),
                "step 0", "residual", "1 iteration", "surface of molecule", n_ranks=n_ranks)


class Sequences(CoupledCase):
    """What a script may do between runs."""

    BODIES = WALL + CELL + scenes.make_particle((0.8, 3, 3))
    SURFACES = "wall walls cells cells viscosity/ratio 2 rigid balls force 0.3 0 0"
    THERMO = "thermo_style custom step f_b[1] f_b[11] f_b[3][1] f_b[3][4]\nthermo 1\n"

    def run_rows(self, end, **options):
        output = self.run_script(self.script(self.BODIES, self.SURFACES, end=self.THERMO + end,
                                             **options))
        return cases.read_thermo(output)

    def test_legal_sequences(self):
        fix = scenes.make_fix(self.SURFACES)
        plain = self.run_rows("run 4\n")
        for end in ("run 0\nrun 4\n", "run 2\nrun 2\n", "run 2\nreset_timestep 2\nrun 2\n",
                    "run 2\nfix_modify b energy no\nrun 2\n"):
            rows = self.run_rows(end)
            self.assertEqual(rows[-1]["Step"], 4)
            self.assertAlmostEqual(rows[-1]["f_b[3][1]"], plain[-1]["f_b[3][1]"], delta=1e-10)
        # an Euler step and a cold start of the iterations: not the same, but near
        rows = self.run_rows("run 2\nunfix b\n" + fix + self.THERMO + "run 2\n")
        self.assertAlmostEqual(rows[-1]["f_b[3][1]"], plain[-1]["f_b[3][1]"], delta=1e-5)

    def test_change_of_the_box(self):
        rows = self.run_rows("run 2\nchange_box all x final 0 7 boundary p p p\nrun 2\n")
        self.assertEqual(rows[-1]["Step"], 4)

    def test_moved_surfaces(self):
        """Walls and particles start where they are at the start of a run."""
        there = self.run_rows("run 0\ndisplace_atoms balls move 0.1 0 0.2 units box\nrun 1\n")
        self.assertAlmostEqual(there[1]["f_b[3][1]"], 0.9, delta=1e-6)
        down = self.run_rows("run 0\ndisplace_atoms walls move 0 0 -0.5 units box\n" + RUN)
        shifted = self.run_rows("displace_atoms walls move 0 0 -0.5 units box\n" + RUN)
        self.assertAlmostEqual(down[-1]["f_b[3][4]"], shifted[-1]["f_b[3][4]"], delta=1e-5)
        # another shape: a particle of its own
        bent = self.run_rows("run 1\ndisplace_atoms balls ramp y 0 0.3 z 2 4 units box\nrun 2\n")
        self.assertEqual(bent[-1]["Step"], 3)

    def test_deleted_atoms(self):
        def after(command):
            return self.script(self.BODIES, self.SURFACES, end=RUN + command + RUN)
        self.expect_errors(
            (after("group one id 110\ndelete_atoms group one compress no mol no\n"), "atom 110",
             "does not exist", "deleted"),
            (after("delete_atoms group balls mol yes\n"), "number of surfaces", "define it anew"))

    def test_moved_into_each_other(self):
        end = RUN + "displace_atoms balls move 0.9 0 0 units box\n" + RUN
        self.expect_error(self.script(self.BODIES, self.SURFACES, end=end),
                          "cell 2 and rigid particle 3")


if __name__ == "__main__":
    unittest.main()
