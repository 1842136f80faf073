"""What a unit of time of whole scenes costs with each stepper, and how far their nodes are then
from a converged run: CSV.

    bench/time_scenes.py --lmp build/lmp_biem --work FOLDER --output scenes.csv
                         [--cells 8] [--nodes 642] [--span 0.5]

The scenes are those of blocks.py, sheared where they have no walls. All runs start from the same
restart file, written after the time 1 by rkc2, and last for the time 'span'. Errors are distances
of the nodes of cells and particles to those of a run with a small step. CPU seconds are of one
process; those of a run without steps are taken off. Rows that the output file has already are not
measured again.
"""

import argparse
from pathlib import Path

from blocks import PARTICLES, WALLS
from time_scene import Program, Table, distances

# Name, walls and platelets, viscosity ratio of the cells.
SCENES = (("cells", False, 1), ("cells of ratio 5", False, 5),
          ("cells, platelets, walls", True, 1), ("cells of ratio 5, platelets, walls", True, 5))
REFERENCE = (0.025, 0.0125)    # time steps of the converged run and of one that tells its error
SHARE = 0.8                    # of the limit of stability of ab2, dt times the spectral radius 1
# Stepper, keywords, time step; None: from the spectral radius.
CASES = (("ab2", "", None), ("rkc2", "", 0.1), ("rkc2", "", 0.05),
         ("rkc2", "multirate yes", 0.1), ("rkc2", "multirate yes", 0.05))
START_TIME, START_STEP = 1.0, 0.05

HEAD = """
units lj
newton on
atom_modify map yes
"""
START = """
atom_style molecular
boundary p p p
region box prism 0 {length!r} 0 {length!r} 0 {length!r} 0 0 0
create_box 3 box angle/types 2 dihedral/types 1
mass * 1.0
{walls}
create_cells rbc nodes {nodes} random {cells} 4711 gap 0.05 group cells
{particles}
"""
REST = """
pair_style none
angle_style hybrid biem/skalak zero
angle_coeff 1 biem/skalak 2.0 100.0
angle_coeff 2 zero
dihedral_style biem/bend
dihedral_coeff 1 0.0066 sphere
neighbor 0.2 bin
timestep {timestep!r}
group bodies type 1 3
fix flow all biem viscosity 1.0 accuracy 1e-3 flow {flow} cells cells viscosity/ratio {ratio} &
  {groups} stepper {stepper} {more}
thermo_style custom step f_flow[28] f_flow f_flow[2] f_flow[24] f_flow[25] f_flow[27] f_flow[30]
thermo_modify format float %.12g
thermo 1
dump d bodies custom {steps} end.dump id xu yu zu f_flow[1] f_flow[2] f_flow[3]
dump_modify d sort id format float %.15g
run {steps}
"""


class SceneProgram(Program):
    """Runs of one scene from one start."""

    def __init__(self, options, scene):
        super().__init__(options.lmp, Path(options.work), "1e-3")
        self.name, self.is_full, self.ratio = scene
        self.options, self.start = options, f"start_{SCENES.index(scene)}"

    def fill(self, stepper, timestep, steps, more):
        groups = "wall walls rigid platelets" if self.is_full else ""
        return REST.format(ratio=self.ratio, groups=groups, stepper=stepper, more=more,
                           flow="mean 1 0 0" if self.is_full else "shear xz 1.0",
                           timestep=timestep, steps=steps)

    def prepare(self):
        """The restart file from which all runs start."""
        if (self.folder / self.start).exists():
            return
        length = (self.options.cells * 4.18879 / 0.2) ** (1.0 / 3.0)    # hematocrit 0.2
        script = HEAD + START.format(length=length, nodes=self.options.nodes,
                                     cells=self.options.cells, walls=WALLS * self.is_full,
                                     particles=PARTICLES * self.is_full)
        script += self.fill("rkc2", START_STEP, round(START_TIME / START_STEP), "")
        self.run_script(script + f"write_restart {self.start}\n", START_TIME)

    def run(self, stepper, timestep, more=""):
        """The run and its CPU seconds without the setup."""
        steps = max(1, round(self.options.span / timestep))
        # Without the state of the fix that wrote the file: histories of another stepper.
        head = HEAD + f"read_restart {self.start}\nreset_timestep 0\ncomm_modify cutoff 0.0\n"
        script = head + self.fill(stepper, self.options.span / steps, steps, more)
        script = script.replace("fix flow ", "fix again ").replace("f_flow", "f_again")
        run = self.run_script(script, self.options.span)
        setup = self.run_script(head + self.fill(stepper, 1e-9, 1, more).replace(
            "fix flow ", "fix again ").replace("f_flow", "f_again"), 1e-9)
        return run, run.cpu_seconds - setup.cpu_seconds


def measure_scene(options, scene, table):
    program = SceneProgram(options, scene)
    program.prepare()
    converged = None
    for stepper, more, timestep in CASES:
        row = {"scene": scene[0], "stepper": stepper, "keywords": more,
               "wanted": timestep or "limit"}
        if table.find(row):
            continue
        if converged is None:
            runs = [program.run("rkc2", step)[0] for step in REFERENCE]
            converged = runs[1]
            own_error = distances(runs[0].positions, converged.positions)[0] / 3.0
        step = timestep or SHARE / converged.largest("radius")
        run, seconds = program.run(stepper, step, more)
        rms, largest = distances(run.positions, converged.positions)
        span = run.last("time")
        table.add({**row, "timestep": f"{span / run.last('step'):.4g}",
                   "evaluations": f"{run.last('evaluations') / span:.4g}",
                   "inner": f"{run.last('cheap') / span:.4g}", "rms_error": f"{rms:.3e}",
                   "max_error": f"{largest:.3e}", "reference_error": f"{own_error:.1e}",
                   "cpu_seconds": f"{seconds / span:.4g}"})


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--lmp", required=True)
    parser.add_argument("--work", required=True, help="folder for restart files")
    parser.add_argument("--output", required=True, help="CSV file; rows are appended")
    parser.add_argument("--cells", type=int, default=8)
    parser.add_argument("--nodes", type=int, default=642)
    parser.add_argument("--span", type=float, default=0.5)
    options = parser.parse_args()
    table = Table(options.output, ("scene", "stepper", "keywords", "wanted"))
    for scene in SCENES:
        measure_scene(options, scene, table)


if __name__ == "__main__":
    main()
