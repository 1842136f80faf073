"""Subcommands flowfield and trajectories: arguments in, files out."""

import os

import numpy as np

from .cell_mesh import CellMesh
from .collisions import compute_path, write_paths
from .errors import BiemAnalysisError
from .flow_field import cut_surface, make_plane_field
from .trajectory import get_positions, universe


def add_flow_commands(commands):
    """Adds the subcommands to those of biem-analysis."""
    field = commands.add_parser("flowfield", help="picture of the velocity on a lattice of points")
    field.add_argument("--data", required=True, metavar="FILE", help="LAMMPS data file")
    field.add_argument("--dump", required=True, metavar="FILE",
                       help="dump custom ... id mol type xu yu zu vx vy vz")
    field.add_argument("--shear-plane", default="xz", metavar="AB",
                       help="axes of the picture (default: %(default)s)")
    field.add_argument("--shear-rate", type=float, default=0.0, metavar="RATE",
                       help="subtract the velocity RATE * (coordinate along B) in direction A")
    field.add_argument("--frame", type=int, default=-1, help="frame of the dump (default: last)")
    field.add_argument("--out", default="flowfield.png", metavar="FILE",
                       help="PNG file to write (default: %(default)s)")
    field.set_defaults(run=run_flow_field)
    paths = commands.add_parser("trajectories",
                                help="paths of one surface relative to another, for several runs")
    paths.add_argument("--data", required=True, nargs="+", metavar="FILE", help="one for each run")
    paths.add_argument("--dump", required=True, nargs="+", metavar="FILE", help="one for each run")
    paths.add_argument("--timestep", type=float, required=True, metavar="DT",
                       help="time step of the runs (LAMMPS command timestep)")
    paths.add_argument("--molecules", type=int, nargs=2, default=(2, 1), metavar=("M", "N"),
                       help="path of molecule M relative to molecule N (default: 2 1)")
    paths.add_argument("--shear-plane", default="xz", metavar="AB",
                       help="axes of the picture (default: %(default)s)")
    paths.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"),
                       help="part of axis A that the picture shows (default: all)")
    paths.add_argument("--out", default="trajectories.png", metavar="FILE",
                       help="PNG file to write; the table is beside it, as .csv "
                       "(default: %(default)s)")
    paths.set_defaults(run=run_trajectories)


def parse_plane(text):
    """Indices of the two axes."""
    if len(text) != 2 or not set(text) <= set("xyz") or text[0] == text[1]:
        raise BiemAnalysisError(f"shear plane '{text}' is not two different letters of x, y, z")
    return "xyz".index(text[0]), "xyz".index(text[1])


def run_flow_field(options):
    """Subcommand flowfield."""
    from .pictures import flow_figures
    first, second = parse_plane(options.shear_plane)
    system = universe(options.data, options.dump)
    n_frames = len(system.trajectory)
    if not -n_frames <= options.frame < n_frames:
        raise BiemAnalysisError(f"there is no frame {options.frame}: '{options.dump}' has "
                                f"{n_frames}")
    timestep = system.trajectory[options.frame]
    if not timestep.has_velocities:
        raise BiemAnalysisError(f"'{options.dump}' has no velocities; add the columns vx vy vz")
    positions = get_positions(timestep)
    mesh = CellMesh(system)
    points = np.setdiff1d(np.arange(len(positions)), mesh.nodes)
    velocity = np.array(timestep.velocities, dtype=float)
    velocity[:, first] -= options.shear_rate * positions[:, second]
    field = make_plane_field(positions[points], velocity[points], first, second)
    outline = cut_surface(positions[mesh.triangles], 3 - first - second, field.level)
    flow_figures.draw_flow_field(field, outline, (first, second), options.out)
    print(f"{options.out}: {len(points)} points, largest velocity "
          f"{np.nanmax(np.linalg.norm(field.velocity, axis=2)):.4g}")


def run_trajectories(options):
    """Subcommand trajectories."""
    from .pictures import flow_figures
    plane = parse_plane(options.shear_plane)
    if len(options.data) != len(options.dump):
        raise BiemAnalysisError(f"{len(options.data)} data files and {len(options.dump)} dumps: "
                                "give one of each for every run")
    paths = [compute_path(data, dump, options.timestep, options.molecules, options.shear_plane)
             for data, dump in zip(options.data, options.dump)]
    table = os.path.splitext(options.out)[0] + ".csv"
    write_paths(paths, table)
    flow_figures.draw_paths(paths, plane, options.out, options.range)
    print(f"{options.out}, {table}: {len(paths)} runs")
