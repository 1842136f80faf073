"""Input scripts of hard scenes, their runs and what is left of them.
Builds on lammps_scripts.py; knows nothing of what is promised."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

import hard_measures as measures

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from lammps_scripts import HEADER, LMP    # noqa: E402

# Type 1: membranes, 2: rigid particles, 3: walls. Angle type 2 and dihedral type 2: no forces.
BOX = HEADER + """neighbor {skin!r} bin
region box prism {box[0]!r} {box[1]!r} {box[2]!r} {box[3]!r} {box[4]!r} {box[5]!r} 0 0 0
create_box 4 box angle/types 2 dihedral/types 2 extra/angle/per/atom 6 extra/dihedral/per/atom 6
mass * 1.0
"""
STYLES = """
{pair}
angle_style hybrid biem/skalak zero
angle_coeff 1 biem/skalak {shear!r} {dilatation!r}
angle_coeff 2 zero
dihedral_style hybrid biem/bend zero
dihedral_coeff 1 biem/bend {bending!r} sphere
dihedral_coeff 2 zero
"""
FLOW = """
{forces}
timestep {timestep!r}
fix flow all biem viscosity 1.0 accuracy {accuracy!r} flow {flow} {surfaces} &
  stepper {stepper} {more}
compute cell all biem/cell
variable t equal f_flow[28]
thermo_style custom step f_flow[28] pe f_flow f_flow[2] f_flow[4] f_flow[6] f_flow[11] &
  f_flow[24] f_flow[30] xz c_cell[1][3] c_cell[1][6] c_cell[1][8]
thermo_modify format float %.12g norm no
thermo 1
"""
NAMES = ("step", "time", "energy", "power", "volume", "velocity", "flips", "iterations",
         "evaluations", "repeated", "tilt", "x", "inclination", "deformation")
OUTPUT = """
dump d all custom {every_dump} cells.dump id mol type xu yu zu
dump_modify d sort id format float %.15g
"""
RUN = """
fix end all halt 1 v_t >= {end!r} error continue
run 100000000
write_dump all custom last.dump id mol type xu yu zu modify sort id format float %.15g
"""
STEPPER = os.environ.get("HARD_STEPPER", "rkc2")


class Scene:
    """All that is in an input script; keywords replace what is here."""

    box = (-3.0, 3.0, -3.0, 3.0, -3.0, 3.0)
    skin = 0.2
    bodies = ""
    nodes = 42
    capillary_number = 1.0
    dilatation = 100.0
    shear = None          # 1/Ca unless given
    pair = "pair_style none"
    forces = ""           # commands before fix biem
    flow = "shear xz 1.0"
    surfaces = ""
    accuracy = 1e-3
    stepper = STEPPER
    timestep = 0.05       # of rkc2; the other steppers take a stable one
    strain = 1.0          # of the membrane at the start; makes that step smaller
    more = ""
    end = 1.0
    frames = 5

    def __init__(self, **changes):
        for name, value in changes.items():
            if not hasattr(type(self), name):
                raise TypeError(f"a scene has no '{name}'")
            setattr(self, name, value)
        if self.shear is None:
            self.shear = 1.0 / self.capillary_number
        if self.stepper != "rkc2" and "timestep" not in changes:
            self.timestep = self.stable_step()

    def stable_step(self):
        edge = 0.35 * np.sqrt(160.0 / (self.nodes - 2))
        return min(0.01, float(0.4 * edge / self.strain
                               / (0.55 * self.dilatation + 1.1 * self.shear)))

    def make_start(self):
        return BOX.format(**self.values()) + self.bodies + self.make_styles()

    def make_styles(self):
        return STYLES.format(**self.values())

    def values(self):
        names = [n for n in dir(Scene) if not n.startswith("_") and not callable(getattr(Scene, n))]
        return {**{n: getattr(self, n) for n in names}, "bending": 3.3e-3 * self.shear}

    def steps(self):
        return int(np.ceil(self.end / self.timestep - 1e-9))

    def make_flow(self):
        return FLOW.format(**self.values())

    def make_output(self):
        return OUTPUT.format(every_dump=max(1, self.steps() // self.frames))

    def make_run(self):
        return RUN.format(end=self.end * (1.0 - 1e-9))

    def make_script(self):
        return (self.make_start() + self.make_flow() + "write_data cells.data nocoeff nofix\n"
                + self.make_output() + self.make_run())


class Outcome:
    """Exit status and output of a run; thermo rows by name; error message or ''."""

    def __init__(self, status, output):
        self.status, self.output = status, output
        found = re.findall(r"^.*ERROR.*$", output, flags=re.MULTILINE)
        self.error = found[0] if found else ("" if status == 0 else f"exit status {status}")
        self.rows = self.read_rows(NAMES)

    def read_rows(self, names):
        """Thermo rows of that many columns, by name."""
        number = r"-?[\d.]+(?:[eE][-+]?\d+)?|-?nan|-?inf"
        pattern = rf"^ *\d+(?: +(?:{number})){{{len(names) - 1}}} *$"
        lines = re.findall(pattern, self.output, flags=re.MULTILINE)
        rows = np.array([line.split() for line in lines], dtype=float).reshape(-1, len(names))
        return dict(zip(names, rows.T))

    def require_success(self):
        if self.status != 0:
            raise AssertionError(f"the run stopped: {self.error or self.output[-600:]}")
        return self


def start(script, folder, prepare=None):
    """The running process; prepare: called in it before the program starts."""
    folder = Path(folder)
    (folder / "in.hard").write_text(script)
    with open(folder / "output.txt", "w") as output:
        return subprocess.Popen([LMP, "-in", "in.hard", "-log", "none"], cwd=folder,
                                preexec_fn=prepare, env=dict(os.environ, OMP_NUM_THREADS="1"),
                                stdout=output, stderr=subprocess.STDOUT)


def finish(process, folder):
    status = process.wait()
    return Outcome(status, (Path(folder) / "output.txt").read_text())


def run(script, folder, prepare=None):
    return finish(start(script, folder, prepare), folder)


def measure(outcome, folder, contacts=False):
    """Measures of a finished run by name."""
    folder = Path(folder)
    frames = [frame for name in ("cells.dump", "last.dump")
              for frame in measures.read_frames(folder / name)]
    surfaces = measures.Surfaces(frames[0], measures.read_triangles(folder / "cells.data"))
    cells = surfaces.molecules_of_type(1)
    found = {"time": outcome.rows["time"][-1], "volume": 0.0, "area": 0.0, "angle": 180.0}

    def sums(function, frame):
        return np.array([function(frame.positions, surfaces.triangles[m]) for m in cells])

    def areas(frame):
        return sums(lambda x, t: measures.compute_areas(x, t).sum(), frame)

    volume, area = sums(measures.compute_volume, frames[0]), areas(frames[0])
    for frame in frames:
        if not np.all(np.isfinite(frame.positions)):
            raise AssertionError(f"positions in step {frame.step} are no numbers")
        found["volume"] = max(found["volume"], np.max(np.abs(
            sums(measures.compute_volume, frame) / volume - 1.0)))
        found["area"] = max(found["area"], np.max(np.abs(areas(frame) / area - 1.0)))
        found["angle"] = min(found["angle"], sums(measures.compute_smallest_angle, frame).min())
    if contacts:
        gaps, inside = zip(*(measures.find_contacts(frame, surfaces) for frame in frames))
        found.update(gap=min(gaps), inside=max(inside))
    found["iterations"] = outcome.rows["iterations"][1:].max()
    found["evaluations"] = outcome.rows["evaluations"][-1] / max(found["time"], 1e-30)
    found["repeated"] = outcome.rows["repeated"][-1]
    return found

