"""Small suspensions in flow: input scripts for fix biem, trajectories of their dumps.
Builds on styles/membrane_cases.py; knows nothing of what is tested."""

from pathlib import Path

import numpy as np

from styles import membrane_cases as cases

DUMP = """
dump d all custom {every} {file} id xu yu zu vx vy vz f_b[1] f_b[2] f_b[3]
dump_modify d sort id format float %.17g
"""


def make_turn(degrees):
    """Rotation about y, from x toward z."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def make_red_cell(center, degrees=0.0, stretch=(1.0, 1.0, 1.0)):
    """Positions and reference of a biconcave disc (Evans & Fung 1972) with about the volume of the
    unit sphere; positions are stretched, turned and moved."""
    sphere, _ = cases.make_icosphere()
    radius = 1.38
    rho2 = np.sum(sphere[:, :2] ** 2, axis=1)
    disc = np.array(sphere) * radius
    disc[:, 2] *= 0.5 * (0.207 + 2.003 * rho2 - 1.123 * rho2 ** 2)
    return disc * stretch @ make_turn(degrees).T + np.asarray(center), disc


def make_header(units="lj", skin=0.2):
    return (f"units {units}\nnewton on\natom_style molecular\natom_modify map yes\n"
            f"boundary p p p\nneighbor {skin!r} bin\n")


def make_styles(shear=2.0, dilatation=100.0, bending=6.6e-3):
    return ("pair_style none\nmass * 1.0\n"
            f"angle_style biem/skalak\nangle_coeff * {shear!r} {dilatation!r}\n"
            f"dihedral_style biem/bend\ndihedral_coeff * {bending!r} sphere\n")


def make_flow(flow="shear xz 1.0", accuracy=1e-3, viscosity=1.0, timestep=0.004, more=""):
    return (f"timestep {timestep!r}\nfix b all biem viscosity {viscosity!r} accuracy {accuracy!r} "
            f"flow {flow} {more}\n")


def make_dump(file, every=1):
    return DUMP.format(file=file, every=every)


def make_script(data, *parts):
    """Reads the data file, then the parts: styles, flow, dump, runs."""
    return make_header() + cases.READ.format(data=data) + "".join(parts)


def run(script, directory, n_ranks=1):
    """Output of a run that has to succeed."""
    result = cases.run(script, directory, n_ranks)
    if result.returncode != 0:
        raise AssertionError(f"lmp_biem ended with {result.returncode}:\n{result.stdout[-3000:]}")
    return result.stdout


def read_dump(path):
    """{step: rows sorted by atom id, without the id}."""
    frames, lines = {}, Path(path).read_text().splitlines()
    start = 0
    while start < len(lines):
        step, n = int(lines[start + 1]), int(lines[start + 3])
        rows = np.loadtxt(lines[start + 9:start + 9 + n], ndmin=2)
        frames[step] = rows[:, 1:]
        start += 9 + n
    return frames


class FlowCase(cases.FolderCase):
    """A folder of its own for each test, with cells.data for the cells."""

    def write(self, *made, box=(6.0, 6.0, 6.0), tilt=(0.0, 0.0, 0.0), **options):
        cases.write_data(self.data, list(made), box=box, tilt=tilt, **options)

    def assert_same_frames(self, one, other, tolerance, steps=None):
        """Positions and velocities of two trajectories."""
        steps = sorted(one) if steps is None else steps
        for step in steps:
            np.testing.assert_allclose(other[step], one[step], rtol=0.0, atol=tolerance,
                                       err_msg=f"step {step}")
