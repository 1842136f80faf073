"""Scenes of rigid particles and walls through lmp_biem: input scripts, runs, rows of numbers of the
particles, reference tables. Knows no tolerances. Units: radius 1 and viscosity 1."""

import csv
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

SOURCE = Path(os.environ.get("BIEM_SOURCE", Path(__file__).resolve().parents[2]))
LMP = os.environ.get("BIEM_LMP", str(SOURCE / "build" / "lmp_biem"))

SCRIPT = """
units lj
newton on
atom_style molecular
atom_modify map yes
boundary p p p
region box prism 0 {box[0]!r} 0 {box[1]!r} 0 {box[2]!r} 0 0 0
create_box 1 box angle/types 1 dihedral/types 1 extra/angle/per/atom 6
mass 1 1.0
{surfaces}
pair_style none
angle_style zero
angle_coeff *
dihedral_style zero
dihedral_coeff *
neighbor 0.1 bin
"""

FLOW = "fix flow all biem viscosity 1.0 accuracy {accuracy!r} {options}\n"

# Columns of the fix's table of surfaces, as slices of a row.
POSITION, VELOCITY, ROTATION = slice(0, 3), slice(3, 6), slice(6, 9)
QUATERNION, FORCE, STRESSLET = slice(9, 13), slice(13, 16), slice(16, 22)
XZ = 20    # of the stresslet
COLUMNS = 22


def read_table(name):
    """Rows of a reference table as dictionaries of numbers."""
    lines = (SOURCE / "tests" / "reference" / f"{name}.csv").read_text().splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [{key: value if key == "lattice" else float(value) for key, value in row.items()}
            for row in rows]


def execute(script):
    """Runs a script in a folder of its own; returns its output."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "in.rigid").write_text(script)
        done = subprocess.run([LMP, "-in", "in.rigid", "-log", "none"], cwd=folder,
                              capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"lmp_biem failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def make_scene(box, surfaces):
    """Input script up to the fix. surfaces: lines create_cells or create_wall."""
    return SCRIPT.format(box=[float(x) for x in box], surfaces="\n".join(surfaces))


def make_sphere(nodes, center, group):
    """Line that creates a sphere of radius 1."""
    return "create_cells sphere radius 1 nodes {} single {!r} {!r} {!r} gap 0 group {}".format(
        nodes, *map(float, center), group)


def evaluate(box, surfaces, loads, accuracy=1e-4, n_bodies=1):
    """One instant under each of several loads (options of fix biem). Returns an array of
    loads x bodies x COLUMNS; bodies are the first n_bodies surfaces."""
    words = " ".join(f"$(f_flow[{body + 1}][{column + 1}]:%.15g)" for body in range(n_bodies)
                     for column in range(COLUMNS))
    script = make_scene(box, surfaces)
    for options in loads:
        script += FLOW.format(accuracy=accuracy, options=options)
        script += f'run 0\nprint "row {words}"\nunfix flow\n'
    rows = [line.split()[1:] for line in execute(script).splitlines() if line.startswith("row ")]
    return np.array(rows, dtype=float).reshape(len(loads), n_bodies, COLUMNS)


def follow(box, surfaces, options, timestep, steps, every, accuracy=1e-4, n_bodies=1, dump=None):
    """Rows of (time, columns of all bodies) in the course of a run, every so many steps."""
    words = " ".join(f"f_flow[{body + 1}][{column + 1}]" for body in range(n_bodies)
                     for column in range(COLUMNS))
    script = make_scene(box, surfaces) + f"timestep {timestep!r}\n"
    script += FLOW.format(accuracy=accuracy, options=options)
    if dump:
        script += (f"dump d all custom {steps} {dump} id xu yu zu\n"
                   "dump_modify d sort id format float %.17g\n")
    script += (f"thermo_style custom step time {words}\nthermo_modify format float %.15g\n"
               f"thermo {every}\nrun {steps}\n")
    rows = []
    for line in execute(script).splitlines():
        try:
            row = [float(word) for word in line.split()]
        except ValueError:
            continue
        if len(row) == 2 + COLUMNS * n_bodies:
            rows.append(row[1:])
    return np.array(rows)


def join(vector):
    return " ".join(repr(float(x)) for x in vector)


# Periodic arrays and single spheres in a cubic box

def compute_array_length(fraction):
    return (4.0 * np.pi / 3.0 / fraction) ** (1.0 / 3.0)


def compute_array_drag(fraction, nodes, accuracy=1e-4):
    """K = F/(6 pi mu a U) of a simple cubic array."""
    length = compute_array_length(fraction)
    surface = make_sphere(nodes, 3 * [0.5 * length], "ball")
    row = evaluate(3 * [length], [surface], ["flow none rigid ball force 1 0 0"], accuracy)[0, 0]
    return 1.0 / (6.0 * np.pi * row[VELOCITY][0])


def compute_array_beta(fraction, nodes, accuracy=1e-4):
    """mu_eff/mu - 1 = S:E/(2 mu V E:E) of an aligned simple cubic array in simple shear xz."""
    length = compute_array_length(fraction)
    surface = make_sphere(nodes, 3 * [0.5 * length], "ball")
    row = evaluate(3 * [length], [surface], ["flow shear xz 1 rigid ball"], accuracy)[0, 0]
    return row[XZ] / length ** 3


def compute_stresslet_ratio(nodes, length=20.0, accuracy=1e-5):
    """Stresslet over 20/3 pi mu a^3 E of a sphere in simple shear, freed of the lattice: to first
    order in the volume fraction c an array has (1 - 0.84 c) of it, by the table of beta."""
    dilute = read_table("periodic_array_viscosity")[0]
    c0, c = dilute["volume_fraction"], 4.0 * np.pi / 3.0 / length ** 3
    lattice = 1.0 + (dilute["beta"] / (2.5 * c0) - 1.0) * c / c0
    return compute_array_beta(c, nodes, accuracy) / (2.5 * c) / lattice


def compute_torque_ratio(nodes, length=12.0, accuracy=1e-5):
    """8 pi mu a^3 W/T of a sphere, freed of the lattice, which slows its rotation by 1 - c."""
    surface = make_sphere(nodes, 3 * [0.5 * length], "ball")
    row = evaluate(3 * [length], [surface],
                   ["flow none rigid ball torque 0 1 0"], accuracy)[0, 0]
    return 8.0 * np.pi * row[ROTATION][1] / (1.0 - 4.0 * np.pi / 3.0 / length ** 3)


# Jeffery's orbit of an oblate spheroid of aspect ratio 1/4, axis in the plane of shear

PLATELET = "create_cells platelet diameter 2 thickness 0.5 nodes {} single {!r} {!r} {!r} group {}"
ASPECT_RATIO = 0.25
JEFFERY_PERIOD = 2.0 * np.pi * (ASPECT_RATIO + 1.0 / ASPECT_RATIO)    # at rate 1


def compute_axis_angles(rows):
    """Angle (continuous in time) of the body's z axis from z toward x, out-of-plane part of it."""
    w, x, y, z = rows[:, 1:][:, QUATERNION].T
    axis = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    return np.unwrap(np.arctan2(axis[0], axis[2])), axis[1]


def run_jeffery(nodes, timestep=0.02, duration=1.02 * JEFFERY_PERIOD, length=16.0):
    """Period over Jeffery's, largest out-of-plane part of the axis, largest drift of the center,
    largest change of a distance between nodes from the first to the last step."""
    surface = PLATELET.format(nodes, *3 * [0.5 * length], "plate") + " orientation 0 0 1"
    steps = round(duration / timestep)
    with tempfile.TemporaryDirectory() as folder:
        dump = str(Path(folder) / "nodes.dump")
        rows = follow(3 * [length], [surface], "flow shear xz 1 rigid plate", timestep, steps, 1,
                      accuracy=1e-3, dump=dump)
        first, last = read_positions(dump)
    angles, out_of_plane = compute_axis_angles(rows)
    turned = angles - angles[0]
    period = np.interp(2.0 * np.pi, turned, rows[:, 0])
    drift = np.linalg.norm(rows[:, 1:][:, POSITION] - 0.5 * length, axis=1).max()
    return {"period": period / JEFFERY_PERIOD, "out_of_plane": np.abs(out_of_plane).max(),
            "drift": drift, "strain": np.abs(distances(last) - distances(first)).max(),
            "nodes_moved": np.abs(last - first).max()}


def read_positions(dump):
    """Positions of the nodes in each frame of a sorted dump."""
    frames, lines = [], Path(dump).read_text().splitlines()
    for start, line in enumerate(lines):
        if line.startswith("ITEM: ATOMS"):
            n = int(lines[start - 5])
            frames.append(np.loadtxt(lines[start + 1:start + 1 + n])[:, 1:])
    return frames


def distances(nodes):
    return np.linalg.norm(nodes[:, None] - nodes[None], axis=2)
