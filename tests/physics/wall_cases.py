"""Flow between walls through lmp_biem: input script, run, results; exact flows of empty vessels
and the errors against them.
Knows no bounds on errors."""

import tempfile
from pathlib import Path

import numpy as np
from lammps_scripts import HEADER, run_script

VISCOSITY = 0.7
DUCT = (3.546, 5.319)    # 10 x 15 um in units of 2.82 um

SCRIPT = HEADER + """region box block 0 {box[0]!r} 0 {box[1]!r} 0 {box[2]!r}
create_box 3 box angle/types 2 dihedral/types 2 extra/angle/per/atom 6 extra/dihedral/per/atom 6
mass * 1.0
{surfaces}
{points}
group points type 3
pair_style none
{styles}
neighbor 0.1 bin
timestep {timestep!r}
fix b all biem viscosity {viscosity!r} accuracy {accuracy!r} flow {flow} {kinds} probes points
run {steps}
write_dump points custom points.dump id vx vy vz modify sort id format float %.15g
write_dump wall custom wall.dump id f_b[4] f_b[5] f_b[6] f_b[7] modify sort id format float %.15g
print "result iterations $(f_b[11]) residual $(f_b[12]:%.6g) mean $(f_b[14]:%.15g) &
drop $(f_b[17]:%.15g) stress $(f_b[20]:%.15g) shear $(f_b[23]:%.15g) first $(f_b[1][14]:%.15g)"
"""

NO_MEMBRANES = "angle_style zero\nangle_coeff *\ndihedral_style zero\ndihedral_coeff *"
MEMBRANES = """angle_style hybrid biem/skalak zero
angle_coeff 1 biem/skalak 1.0 100.0
angle_coeff 2 zero
dihedral_style hybrid biem/bend zero
dihedral_coeff 1 biem/bend 0.0033 sphere
dihedral_coeff 2 zero"""


def read_dump(path):
    """Rows of a dump without their ids."""
    return np.loadtxt(path.read_text().splitlines()[9:], ndmin=2)[:, 1:]


class Scene:
    """A box with walls in the group `wall`, and what else the surfaces say."""

    def __init__(self, box, surfaces, kinds="wall wall", styles=NO_MEMBRANES, files=None):
        self.box, self.surfaces, self.kinds, self.styles = box, surfaces, kinds, styles
        self.files = files or {}

    @property
    def volume(self):
        return float(np.prod(self.box))

    def run(self, flow, points=(), accuracy=1e-5, steps=0, timestep=0.004):
        """Dictionary of the numbers of the last step (`first` is the force of molecule 1 on the
        fluid along x), `velocity` (n_points, 3) and the `force` (3,) of the fluid on the walls as
        the sum over their nodes."""
        made = "\n".join("create_atoms 3 single %.15g %.15g %.15g units box" % tuple(p)
                         for p in points) or "create_atoms 3 single 0.1 0.1 0.1 units box"
        script = SCRIPT.format(box=self.box, surfaces=self.surfaces, points=made,
                               styles=self.styles, timestep=timestep, viscosity=VISCOSITY,
                               accuracy=accuracy, flow=flow, kinds=self.kinds,
                               steps=steps)
        with tempfile.TemporaryDirectory() as folder:
            for name, text in self.files.items():
                (Path(folder) / name).write_text(text)
            output = run_script(script, folder)
            velocity, wall = (read_dump(Path(folder) / f"{name}.dump")
                              for name in ("points", "wall"))
        words = next(line for line in output.splitlines()
                     if line.startswith("result")).split()[1:]
        result = dict(zip(words[::2], map(float, words[1::2])))
        result["velocity"] = velocity[:len(points)]
        result["force"] = -wall[:, 3] @ wall[:, :3]
        return result


def make_sheet_off(lengths, steps, seed=None, jitter=0.25):
    """OFF text of the sheet z = 0 that spans the box; with a seed, nodes are shifted at random in
    the plane, by up to `jitter` of the spacing, alike on opposite faces of the box."""
    n, m = steps
    shift = np.zeros((n, m, 2))
    if seed is not None:
        shift = np.random.default_rng(seed).uniform(-jitter, jitter, (n, m, 2))
        shift[0, :, 0] = shift[:, 0, 1] = 0.0
    nodes = [((i + shift[i % n, j % m, 0]) * lengths[0] / n,
              (j + shift[i % n, j % m, 1]) * lengths[1] / m, 0.0)
             for j in range(m + 1) for i in range(n + 1)]
    faces = []
    for j in range(m):
        for i in range(n):
            k = i + (n + 1) * j
            if (i + j) % 2:
                faces += [(k, k + 1, k + n + 2), (k, k + n + 2, k + n + 1)]
            else:
                faces += [(k, k + 1, k + n + 1), (k + 1, k + n + 2, k + n + 1)]
    lines = [f"OFF\n{len(nodes)} {len(faces)} 0"] + ["%.15g %.15g %.15g" % p for p in nodes]
    return "\n".join(lines + ["3 %d %d %d" % f for f in faces]) + "\n"


def make_tube_stl(length, radius, center, steps):
    """STL text of a cylinder along x from 0 to `length`, corners counter-clockwise from inside."""
    n, around = steps
    turn = 2.0 * np.pi / around
    radius = radius * np.sqrt(turn / np.sin(turn))    # the polygon has the area of the circle

    def corner(i, j):
        angle = turn * (j % around)
        return (length * i / n, center[0] + radius * np.cos(angle),
                center[1] + radius * np.sin(angle))

    lines = ["solid tube"]
    for i in range(n):
        for j in range(around):
            a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
            for triangle in ((a, b, c), (a, c, d)):
                lines += ["facet normal 0 0 0", "outer loop"]
                lines += ["vertex %.9g %.9g %.9g" % p for p in triangle] + ["endloop", "endfacet"]
    return "\n".join(lines + ["endsolid tube"]) + "\n"


# Exact flows of empty vessels for the pressure drop 1 and the viscosity 1.

def channel_velocity(height, z):
    """Between plane walls; the mean is height^2/12, the wall shear rate height/2."""
    return 0.5 * z * (height - z)


def duct_velocity(sides, y, z):
    """Series in the duct 0 < y < sides[0], 0 < z < sides[1] (White, Viscous Fluid Flow, 3-48)."""
    a, b = sides
    k = np.arange(1, 400, 2)
    waves = np.pi * k / a
    z = abs(z - 0.5 * b)
    ratio = (np.exp(waves * (z - 0.5 * b)) + np.exp(-waves * (z + 0.5 * b))) / (
        1.0 + np.exp(-waves * b))    # cosh(waves z) / cosh(waves b/2)
    return float(np.sum(4.0 * a * a / (np.pi * k) ** 3 * (1.0 - ratio) * np.sin(waves * y)))


def duct_mean(sides):
    """Mean velocity; its inverse is the resistance."""
    a, b = sides
    k = np.arange(1, 400, 2)
    return a * a / 12.0 * (1.0 - 192.0 * a / (np.pi ** 5 * b)
                           * np.sum(np.tanh(0.5 * k * np.pi * b / a) / k ** 5))


def tube_array_mean(radius, side):
    """Mean over the box of the flow in and around parallel tubes in a square array: Poiseuille
    inside, Drummond & Tahir (1984), Eq. 26 outside (to about 1e-4 for fractions up to 0.3)."""
    c = np.pi * radius ** 2 / side ** 2
    around = radius ** 2 / (4.0 * c) * (-np.log(c) - 1.476335966 + 2.0 * c - 0.5 * c ** 2
                                        - 0.0509713 * c ** 4 / (1.0 + 1.51978 * c ** 4))
    return around + c * radius ** 2 / 8.0


# Errors of empty vessels.

CHANNEL = (3.2, 2.4, 4.0)
TUBE_SIDE, TUBE_RADIUS, TUBE_LENGTH = 4.0, 1.2, 2.4


def make_channel(edge):
    return Scene(CHANNEL, f"create_wall plane z 0 edge {edge!r} group wall")


def make_duct(edge):
    return Scene((3.2,) + DUCT, f"create_wall duct 0 0 edge {edge!r} axis x group wall")


def make_tube(edge, wall="wall wall"):
    center = 0.5 * TUBE_SIDE
    return Scene((TUBE_LENGTH, TUBE_SIDE, TUBE_SIDE), f"create_wall tube axis x radius "
                 f"{TUBE_RADIUS!r} center {center!r} {center!r} edge {edge!r} group wall", wall)


def measure_channel(scene, flow):
    """Relative errors for a channel between z = 0 and the height of the box: resistance, maximum
    and largest error of the profile (of the mean velocity), wall shear rate, balance of forces."""
    height = scene.box[2]
    z = height * np.array([0.01, 0.05, 0.2, 0.35, 0.5, 0.7, 0.9])
    result = scene.run(flow, [(0.31, 0.47, place) for place in z])
    drop, mean = result["drop"] / VISCOSITY, result["mean"]
    exact = 6.0 * mean * 2.0 / height ** 2 * channel_velocity(height, z)
    speed = result["velocity"][:, 0]
    return {"resistance": drop * height ** 2 / 12.0 / mean - 1.0,
            "maximum": speed[4] / (1.5 * mean) - 1.0,
            "profile": np.abs(speed - exact).max() / mean,
            "shear": result["shear"] * height / (6.0 * mean) - 1.0,
            "balance": result["force"][0] / (result["drop"] * scene.volume) - 1.0,
            "iterations": result["iterations"]}


def measure_duct(edge, flow="mean 1 0 0"):
    """As measure_channel; `corner` is the error of the velocity close to an edge of the duct."""
    scene = make_duct(edge)
    a, b = DUCT
    places = [(0.5 * a, 0.5 * b), (0.25 * a, 0.5 * b), (0.25 * a, 0.25 * b), (0.8 * a, 0.1 * b),
              (0.1 * a, 0.6 * b), (0.3, 0.3)]
    result = scene.run(flow, [(0.31,) + place for place in places])
    mean = result["mean"]
    exact = np.array([duct_velocity(DUCT, *place) for place in places]) * mean / duct_mean(DUCT)
    error = (result["velocity"][:, 0] - exact) / mean
    return {"resistance": result["drop"] / VISCOSITY * duct_mean(DUCT) / mean - 1.0,
            "maximum": error[0] * mean / exact[0],
            "profile": np.abs(error[:-1]).max(), "corner": abs(error[-1]),
            "shear": result["shear"] * duct_mean(DUCT) * 2.0 * (a + b) / (mean * a * b) - 1.0,
            "balance": result["force"][0] / (result["drop"] * scene.volume) - 1.0,
            "iterations": result["iterations"]}


def measure_tube(scene, wall_velocity=0.0):
    """Relative errors for the tube at a given pressure drop: mean over the box (inside and
    outside), maximum, largest error of the profile (of the mean inside), balance of forces."""
    center, radius = 0.5 * TUBE_SIDE, TUBE_RADIUS
    r = radius * np.array([0.0, 0.25, 0.5, 0.75, 0.9])
    result = scene.run("pressure/drop 1 0 0", [(0.31, center + place, center) for place in r])
    exact = (radius ** 2 - r ** 2) / (4.0 * VISCOSITY)
    error = result["velocity"][:, 0] - wall_velocity - exact
    outside = tube_array_mean(radius, TUBE_SIDE) / VISCOSITY
    return {"mean": (result["mean"] - wall_velocity) / outside - 1.0,
            "maximum": error[0] / exact[0], "profile": np.abs(error).max() / (0.5 * exact[0]),
            "balance": result["force"][0] / (result["drop"] * scene.volume) - 1.0,
            "iterations": result["iterations"]}


def format_errors(errors):
    """One line for the eye."""
    return ", ".join(f"{name} {value:.2g}" for name, value in errors.items())


# A channel with a red cell and a platelet.

CROWDED = Scene(
    (4.0, 3.6, 4.0),
    "create_wall plane z 0 edge 0.5 group wall angle_type 2\n"
    "create_cells rbc nodes 162 single 1.6 1.8 1.5 orientation 1 0 1 group rbc\n"
    "create_cells platelet diameter 0.993 thickness 0.248 nodes 162 single 2.6 1.8 3.2 "
    "orientation 0.2 0.1 1 group platelet angle_type 2 dihedral_type 2",
    "wall wall rigid platelet cells rbc", MEMBRANES)
PLATELET = np.array([2.6, 1.8, 3.2])


def make_sphere_rule(radius, n=10):
    """Points (m, 3) and weights of the Gauss product rule on a sphere around the origin."""
    height, weight = np.polynomial.legendre.leggauss(n)
    turn = 2.0 * np.pi * (np.arange(2 * n) + 0.5) / (2 * n)
    height, angle = (grid.ravel() for grid in np.meshgrid(height, turn, indexing="ij"))
    rho = np.sqrt(1.0 - height ** 2)
    points = radius * np.column_stack([rho * np.cos(angle), rho * np.sin(angle), height])
    return points, np.repeat(weight, 2 * n) * np.pi / n * radius ** 2
