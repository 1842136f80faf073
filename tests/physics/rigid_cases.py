"""Scenes of rigid particles and walls through lmp_biem: input scripts, runs, rows of numbers of the
particles, reference tables. Knows no tolerances. Units: radius 1 and viscosity 1."""

import csv
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from lammps_scripts import HEADER, SOURCE, run_script

SCRIPT = HEADER + """region box prism 0 {box[0]!r} 0 {box[1]!r} 0 {box[2]!r} 0 0 0
create_box 1 box angle/types 1 dihedral/types 1 extra/angle/per/atom 6
mass 1 1.0
{surfaces}
pair_style none
angle_style zero
angle_coeff *
dihedral_style zero
dihedral_coeff *
neighbor 0.1 bin
neigh_modify one 8000 page 1000000
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
        return run_script(script, folder)


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


def run_all(function, *arguments):
    """As map(), two runs at a time."""
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(function, *arguments))


def compute_order(errors):
    """Of the error in the mesh size, between meshes of 4 times as many nodes."""
    errors = np.abs(errors)
    return np.log2(errors[:-1] / errors[1:])


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
    center = [0.5 * length, 0.5 * length, 0.0]    # where the flow is at rest
    surface = PLATELET.format(nodes, *center, "plate") + " orientation 0 0 1"
    steps = round(duration / timestep)
    with tempfile.TemporaryDirectory() as folder:
        dump = str(Path(folder) / "nodes.dump")
        rows = follow(3 * [length], [surface], "flow shear xz 1 rigid plate", timestep, steps, 1,
                      accuracy=1e-3, dump=dump)
        first, last = read_positions(dump)
    angles, out_of_plane = compute_axis_angles(rows)
    turned = angles - angles[0]
    period = np.interp(2.0 * np.pi, turned, rows[:, 0])
    drift = np.linalg.norm(rows[:, 1:][:, POSITION] - center, axis=1).max()
    return {"period": period / JEFFERY_PERIOD, "out_of_plane": np.abs(out_of_plane).max(),
            "drift": drift, "strain": np.abs(distances(last) - distances(first)).max(),
            "nodes_moved": np.abs(last - first).max()}


def compute_slow_rotation(nodes, roll, length=16.0, accuracy=1e-4):
    """Rotation over the exact 1/17 of the shear rate, the slowest of the orbit: axis across the
    flow in the plane of shear; roll: of the mesh about the axis [degrees]."""
    surface = PLATELET.format(nodes, 0.5 * length, 0.5 * length, 0.0, "plate")
    row = evaluate(3 * [length], [surface + f" orientation 0 0 1 roll {roll}"],
                   ["flow shear xz 1 rigid plate"], accuracy)[0, 0]
    return row[ROTATION][1] * (1.0 + ASPECT_RATIO ** -2)


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


# Two spheres in unbounded fluid

def compute_pair_mobilities(gap, nodes, lengths=(50.0, 100.0), accuracy=1e-5):
    """x11, x12, y11, y12 times 6 pi mu a: equal and opposite forces along and across. The force
    that a box of length L takes back slows it by 2.837 F/(6 pi mu L); what is left falls as 1/L^3
    and is extrapolated."""
    found = []
    for length in lengths:
        middle, half = 0.5 * length, 1.0 + 0.5 * gap
        surfaces = [make_sphere(nodes, [middle - half, middle, middle], "one"),
                    make_sphere(nodes, [middle + half, middle, middle], "two")]
        loads = [f"flow none rigid one force 1 0 1 rigid two force {sign} 0 {sign}"
                 for sign in (1, -1)]
        rows = evaluate(3 * [length], surfaces, loads, accuracy, 2)
        velocities = 6.0 * np.pi * rows[..., VELOCITY]
        same = 0.5 * (velocities[0, 0] + velocities[0, 1]) + 2.0 * 2.837297 / length
        opposite = 0.5 * (velocities[1, 0] - velocities[1, 1])
        found.append(0.5 * np.array([same + opposite, same - opposite])[:, [0, 2]].T.ravel())
    weight = (lengths[1] / lengths[0]) ** 3
    return (weight * found[1] - found[0]) / (weight - 1.0)


# A sphere near one wall: the box's own sheet at z = 0, the next one far away

SQUARE_SUM = 9.0336217    # of 1/R^3 over a square lattice of distance 1, without the origin


def compute_lattice_shear(length, height):
    """Shear rate at a particle that its images beside a wall cause, by first moment int z f_x dA of
    the forces on the fluid and viscosity. Blake (1971): far from a force along a wall,
    u = 12 h z x^2/(8 pi mu r^5); without pressure gradient the other wall slows the mean flow."""
    return 6.0 * SQUARE_SUM / (8.0 * np.pi * length ** 3) - 1.0 / (height * length ** 2)


def run_above_wall(h, nodes, edge, length, accuracy=1e-5):
    """Rows of a sphere at height h under a force x, a force z, a torque y; and in shear of rate 1
    by moving walls. The other wall is as far as the next image."""
    height = length
    sphere = make_sphere(nodes, [0.5 * length, 0.5 * length, h], "ball")
    wall = "create_wall plane z {!r} edge {!r} group {}"
    still = "flow pressure/drop 0 0 0 wall low"
    driven = evaluate([length, length, height], [sphere, wall.format(0.0, edge, "low")],
                      [f"{still} rigid ball force 1 0 0", f"{still} rigid ball force 0 0 1",
                       f"{still} rigid ball torque 0 1 0"], accuracy)[:, 0]
    sheared = evaluate([length, length, 2.0 * height],
                       [sphere, wall.format(0.0, edge, "low"), wall.format(height, edge, "high")],
                       [f"{still} wall high velocity {height!r} 0 0 rigid ball"], accuracy)[0, 0]
    return (*driven, sheared)


def compute_wall_coefficients(h, nodes, edge, length, accuracy=1e-5):
    """The columns of tests/reference/sphere_near_wall.csv, freed of the periodic images: these are
    far away and act as a shear flow. Resistances are the inverse of the measured mobilities."""
    along, across, turned, sheared = run_above_wall(h, nodes, edge, length, accuracy)
    lattice = compute_lattice_shear(length, length)

    def motion(row):
        return np.array([row[VELOCITY][0], row[ROTATION][1]])

    free = motion(sheared) / (1.0 - lattice * sheared[XZ])
    by_force = motion(along) - lattice * (h - along[XZ]) * free
    by_torque = motion(turned) - lattice * (0.5 - turned[XZ]) * free
    resistance = np.linalg.inv(np.array([by_force, by_torque]).T)
    held = resistance @ free
    return {"drag_perpendicular": 1.0 / (6.0 * np.pi * across[VELOCITY][2]),
            "Ft": -resistance[0, 0] / (6.0 * np.pi), "Tt": -resistance[1, 0] / (8.0 * np.pi),
            "Tr": -resistance[1, 1] / (8.0 * np.pi), "Fs": held[0] / (6.0 * np.pi * h),
            "Ts": held[1] / (4.0 * np.pi), "U_free_over_hS": free[0] / h,
            "Omega_free_over_half_S": 2.0 * free[1]}


# A sphere in a channel: the box's own sheet is both walls

# Faxen, in Happel & Brenner (1983), Eqs. 7-4.28 and 7-4.34: powers of radius over distance to the
# nearest wall, in the middle and at a quarter of the width.
FAXEN = {0.5: {1: -1.004, 3: 0.418, 4: 0.21, 5: -0.169},
         0.25: {1: -0.6526, 3: 0.1475, 4: -0.131, 5: -0.0644}}


def compute_faxen_mobility(place, width):
    """6 pi mu a U/F along the walls."""
    ratio = 1.0 / (place * width)
    return 1.0 + sum(c * ratio ** power for power, c in FAXEN[place].items())


def compute_channel_mobility(place, width, nodes, edge, accuracy=1e-5):
    """6 pi mu a U/F along the walls, free of torque. The images far away act as the parabolic flow
    that makes the mean without flow differ from the one without pressure gradient, with half its
    strength and opposite signs in the two: their average has none."""
    length = 4.0 * width
    surfaces = [make_sphere(nodes, [0.5 * length, 0.5 * length, place * width], "ball"),
                f"create_wall plane z 0 edge {edge!r} group walls"]
    rows = evaluate([length, length, width], surfaces,
                    [f"flow {flow} wall walls rigid ball force 1 0 0"
                     for flow in ("none", "pressure/drop 0 0 0")], accuracy)
    return 6.0 * np.pi * rows[:, 0, VELOCITY][:, 0].mean()


# Mobility of several bodies

def measure_grand_mobility(box, surfaces, groups, walls=(), accuracy=1e-5):
    """6n x 6n: velocities and rotations of the bodies, by forces and torques on each."""
    fixed = "flow none " + " ".join(f"wall {wall}" for wall in walls)
    loads = []
    for k in range(6 * len(groups)):
        load = np.zeros(6 * len(groups))
        load[k] = 1.0
        loads.append(" ".join([fixed] + [
            f"rigid {group} force {join(part[:3])} torque {join(part[3:])}"
            for group, part in zip(groups, load.reshape(-1, 6))]))
    rows = evaluate(box, surfaces, loads, accuracy, len(groups))
    return np.concatenate([rows[..., VELOCITY], rows[..., ROTATION]], axis=2).reshape(
        len(loads), -1).T


def measure_reciprocity(nodes, edge, accuracy=1e-5):
    """Asymmetry of the mobility of a sphere and a tilted platelet between walls, relative: of what
    one does to the other, and of all; smallest eigenvalue over the largest."""
    box = [7.0, 7.0, 5.0]
    surfaces = [make_sphere(nodes, [2.0, 3.0, 1.5], "ball"),
                PLATELET.format(nodes, 4.3, 3.5, 2.0, "plate") + " orientation 0.5 0.3 1",
                f"create_wall plane z 0 edge {edge!r} group walls"]
    mobility = measure_grand_mobility(box, surfaces, ["ball", "plate"], ["walls"], accuracy)
    cross, back = mobility[:6, 6:], mobility[6:, :6].T
    eigenvalues = np.linalg.eigvalsh(0.5 * (mobility + mobility.T))
    return {"cross": np.linalg.norm(cross - back) / np.linalg.norm(cross),
            "all": np.linalg.norm(mobility - mobility.T) / np.linalg.norm(mobility),
            "eigenvalues": eigenvalues[0] / eigenvalues[-1]}


def compare_pushes(nodes, accuracy=1e-4):
    """Motions (velocity, rotation) of a platelet whose one node is pushed by fix addforce, and by
    the same force and its torque as options of fix biem."""
    push, node, center = np.array([0.7, -0.4, 1.1]), 17, np.array([3.0, 2.0, 2.5])
    plate = PLATELET.format(nodes, *center, "plate") + " orientation 1 2 3"
    columns = range(POSITION.start, ROTATION.stop)
    row = "print \"row " + " ".join(f"$(f_flow[1][{c + 1}]:%.16g)" for c in columns)
    script = make_scene([7.0, 6.0, 5.0], [plate])
    script += f"group tip id {node}\nfix push tip addforce {join(push)}\n"
    script += FLOW.format(accuracy=accuracy, options="flow shear xz 1 rigid plate")
    script += f"run 0\n{row} $(x[{node}]:%.16g) $(y[{node}]:%.16g) $(z[{node}]:%.16g)\"\n"
    pushed = [np.array(line.split()[1:], dtype=float) for line in execute(script).splitlines()
              if line.startswith("row ")][0]
    torque = np.cross(pushed[9:12] - pushed[POSITION], push)
    options = f"flow shear xz 1 rigid plate force {join(push)} torque {join(torque)}"
    given = evaluate([7.0, 6.0, 5.0], [plate], [options], accuracy)[0, 0]
    return pushed[3:9], given[3:9]
