"""One red cell in shear: its input script, runs of it, distances between end positions, and the
table that is written. Knows nothing of what is compared."""

import csv
import os
import re
import resource
import subprocess
from pathlib import Path

import numpy as np

HEAD = """
units lj
newton on
atom_modify map yes
"""
START = """
atom_style molecular
boundary p p p
region box prism -3 3 -3 3 -3 3 0 0 0
create_box 1 box angle/types 1 dihedral/types 1
mass * 1.0
create_cells rbc nodes {nodes} single 0 0 0 orientation -0.5 0 1
"""
# Another ID of fix biem than that of the run which wrote the file: without what steppers remember.
GO_ON = """
read_restart {restart}
reset_timestep 0
comm_modify cutoff 0.0
"""
REST = """
pair_style none
angle_style biem/skalak
angle_coeff * {shear!r} {dilatation!r}
dihedral_style biem/bend
dihedral_coeff * {bending!r} sphere
neighbor 0.2 bin
timestep {timestep!r}
fix {id} all biem viscosity 1.0 accuracy {accuracy} flow shear xz 1.0 stepper {stepper} {more}
variable t equal f_{id}[28]
thermo_style custom step f_{id}[28] f_{id} f_{id}[2] f_{id}[24] f_{id}[25] f_{id}[27] f_{id}[30]
thermo_modify format float %.12g
thermo {every_thermo}
dump d all custom {every_dump} end.dump id xu yu zu f_{id}[1] f_{id}[2] f_{id}[3]
dump_modify d sort id format float %.15g
{halt}
run {steps}
"""
HALT = "fix end all halt 1 v_t >= {end!r} error continue"
MANY_STEPS = 10 ** 7
COLUMNS = ("step", "time", "power", "volume_error", "evaluations", "cheap", "radius", "repeated")


class Cell:
    """Moduli and mesh of the cell (Zhao et al. 2012: ES = 1/Ca, ED = 100, EB = 3.3e-3/Ca).
    restart: file from which its runs go on, or None."""

    restart = None

    def __init__(self, nodes, capillary_number, dilatation=100.0):
        self.nodes, self.capillary_number, self.dilatation = nodes, capillary_number, dilatation
        self.shear = 1.0 / capillary_number
        self.bending = 3.3e-3 / capillary_number

    def name(self):
        return f"{self.nodes}_{self.capillary_number:g}_{self.dilatation:g}"


class Stopped(Exception):
    """The program ended with an error; the text is its message."""


class Run:
    """End positions (n x 3) and what was spent to get there."""

    def __init__(self, rows, positions, cpu_seconds):
        self.rows, self.positions, self.cpu_seconds = rows, positions, cpu_seconds

    def last(self, name):
        return self.rows[-1][COLUMNS.index(name)]

    def mean_power(self):
        return float(np.mean(np.abs(self.rows[1:, COLUMNS.index("power")])))

    def largest(self, name):
        return float(np.max(self.rows[:, COLUMNS.index(name)]))


class Program:
    """lmp_biem in a work folder."""

    def __init__(self, lmp, folder, accuracy):
        self.lmp, self.folder, self.accuracy = str(Path(lmp).resolve()), Path(folder), accuracy
        self.folder.mkdir(parents=True, exist_ok=True)

    def run(self, cell, stepper, timestep, end, more=""):
        """To the time end; with a step that the program may change when 'more' has a tolerance."""
        return self.run_script(self.make_script(cell, stepper, timestep, end, more), end)

    def make_script(self, cell, stepper, timestep, end, more=""):
        is_free = "error/tolerance" in more
        steps = MANY_STEPS if is_free else max(1, round(end / timestep))
        every = 1 if is_free else steps
        return (HEAD + (GO_ON if cell.restart else START) + REST).format(
            nodes=cell.nodes, shear=cell.shear, dilatation=cell.dilatation, bending=cell.bending,
            timestep=timestep if is_free else end / steps, accuracy=self.accuracy, stepper=stepper,
            more=more, steps=steps, every_dump=every, every_thermo=max(1, every // 50),
            id="again" if cell.restart else "flow", restart=cell.restart,
            halt=HALT.format(end=end) if is_free else "")

    def prepare_restart(self, cell, timestep):
        """Name of the file with the state at the time 1."""
        name = f"restart_{cell.name()}"
        if not (self.folder / name).exists():
            script = self.make_script(cell, "rkc2", timestep, 1.0)
            self.run_script(script + f"write_restart {name}\n", 1.0)
        return name

    def run_script(self, script, end):
        (self.folder / "in.time").write_text(script)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([self.lmp, "-in", "in.time", "-log", "none"], cwd=self.folder,
                              env=dict(os.environ, OMP_NUM_THREADS="1"), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode:
            errors = [line for line in done.stdout.splitlines() if "ERROR" in line]
            raise Stopped(errors[0] if errors else f"exit status {done.returncode}")
        rows = np.array(read_thermo(done.stdout))
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return Run(rows, read_end(self.folder / "end.dump", rows, end), cpu)


def read_thermo(output):
    """The lines that have as many numbers as there are columns."""
    number = r"-?[\d.]+(?:[eE][-+]?\d+)?|-?nan|-?inf"
    pattern = rf"^ *\d+(?: +(?:{number})){{{len(COLUMNS) - 1}}} *$"
    lines = re.findall(pattern, output, flags=re.MULTILINE)
    return [[float(word) for word in line.split()] for line in lines]


def read_frame(text):
    """(step, n x 6 of positions and velocities); sorted by id. The background flow is (z, 0, 0)."""
    lines = text.splitlines()
    rows = np.array([line.split()[1:] for line in lines[9:]], dtype=float)
    rows[:, 3] += rows[:, 2]
    return int(lines[1]), rows


def read_end(path, rows, end):
    """Positions at the time 'end': those of the last frame, or the cubic through the last two."""
    parts = path.read_text().split("ITEM: TIMESTEP\n")
    times = {int(row[0]): row[1] for row in rows}
    frames = [read_frame("ITEM: TIMESTEP\n" + part) for part in parts[-2:]]
    (step_1, one), (step_2, two) = frames
    if not np.all(np.isfinite(two)):
        raise Stopped("positions that are no numbers")
    t_1, t_2 = times[step_1], times[step_2]
    if abs(t_2 - end) < 1e-9 * end:
        return two[:, :3]
    h = t_2 - t_1
    s = (end - t_1) / h
    if not 0.0 <= s <= 1.0:
        raise Stopped(f"the run ended at the time {t_2}, not at {end}")
    x_1, u_1, x_2, u_2 = one[:, :3], one[:, 3:], two[:, :3], two[:, 3:]
    return ((1 + 2 * s) * (1 - s) ** 2 * x_1 + s * (1 - s) ** 2 * h * u_1
            + s * s * (3 - 2 * s) * x_2 + s * s * (s - 1) * h * u_2)


def distances(one, other):
    """(rms, largest) distance of the nodes."""
    squares = np.sum((one - other) ** 2, axis=1)
    return float(np.sqrt(np.mean(squares))), float(np.sqrt(np.max(squares)))


class Table:
    """A CSV file that grows by a row at a time."""

    def __init__(self, path, keys):
        self.path, self.keys, self.rows = Path(path), keys, []
        if self.path.exists():
            with self.path.open(newline="") as file:
                self.rows = list(csv.DictReader(file))

    def find(self, row):
        """The row that was measured before, or None."""
        wanted = [str(row[key]) for key in self.keys]
        return next((r for r in self.rows if [r[key] for key in self.keys] == wanted), None)

    def add(self, row):
        row = {key: str(value) for key, value in row.items()}
        is_new = not self.rows
        self.rows.append(row)
        with self.path.open("a", newline="") as file:
            writer = csv.DictWriter(file, row.keys())
            if is_new:
                writer.writeheader()
            writer.writerow(row)
        print(", ".join(f"{key} {value}" for key, value in row.items() if value), flush=True)
        return row
