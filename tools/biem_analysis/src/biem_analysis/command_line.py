"""The command biem-analysis: arguments in, files out; the work is done elsewhere."""

import argparse
import os
import sys
import time as clock

import numpy as np

from .cell_shapes import AXIS_NAMES, CellShapes
from .cross_profile import CrossProfile
from .data_file import read_reference_shape
from .errors import BiemAnalysisError
from .flow_command import add_flow_commands
from .trajectory import get_positions, universe
from .version import __version__


def main(arguments=None):
    """Run the command; returns the exit status (0 success, 1 error in the input)."""
    options = make_parser().parse_args(arguments)
    try:
        options.run(options)
    except (BiemAnalysisError, OSError) as error:
        print(f"biem-analysis: error: {error}", file=sys.stderr)
        return 1
    return 0


def make_parser():
    """The command's arguments."""
    parser = argparse.ArgumentParser(
        prog="biem-analysis",
        description="Shapes and pictures of the deformable cells of a LAMMPS run with USER-BIEM.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    shapes = commands.add_parser("shapes", help="table of cell shapes in time (CSV)")
    add_input_arguments(shapes)
    add_shear_plane(shapes)
    shapes.add_argument("--out", default="shapes.csv", metavar="FILE",
                        help="CSV file to write (default: %(default)s)")
    shapes.add_argument("--reference", choices=("first", "data"), default="first",
                        help="shape for area strain: first frame used, or the reference shape in "
                        "the data file (written without nofix) (default: %(default)s)")
    shapes.set_defaults(run=run_shapes)
    pictures = commands.add_parser("pictures", help="pictures of the cells and curves (PNG)")
    add_input_arguments(pictures)
    add_shear_plane(pictures)
    pictures.add_argument("--out", default="pictures", metavar="DIR",
                          help="folder to write to, made if needed (default: %(default)s)")
    pictures.add_argument("--panels", type=positive_integer, default=4, metavar="N",
                          help="number of snapshots (default: %(default)s)")
    pictures.add_argument("--width", type=positive_integer, default=1800, metavar="PIXELS",
                          help="width of the large picture (default: %(default)s)")
    pictures.add_argument("--no-marker", action="store_true",
                          help="leave out the bright spot that shows the membrane turning")
    pictures.set_defaults(run=run_pictures)
    profile = commands.add_parser("profile", help="volume fraction and velocity across a channel")
    add_input_arguments(profile)
    profile.add_argument("--axis", choices=AXIS_NAMES, default="z",
                         help="coordinate of the profile (default: %(default)s)")
    profile.add_argument("--flow", choices=AXIS_NAMES, default="x",
                         help="component of the velocity (default: %(default)s)")
    profile.add_argument("--bins", type=positive_integer, default=24, metavar="N",
                         help="number of bins over the box (default: %(default)s)")
    profile.add_argument("--points", type=positive_integer, nargs="+", metavar="TYPE",
                         help="atom types of points in the flow, probes or tracers (default: no "
                         "velocity)")
    profile.add_argument("--out", default="profile", metavar="DIR",
                         help="folder to write to, made if needed (default: %(default)s)")
    profile.set_defaults(run=run_profile)
    add_flow_commands(commands)
    return parser


def add_input_arguments(parser):
    """Arguments that all commands have."""
    parser.add_argument("--data", required=True, metavar="FILE",
                        help="LAMMPS data file: write_data cells.data nocoeff nofix")
    parser.add_argument("--dump", required=True, metavar="FILE",
                        help="dump custom ... id mol type xu yu zu vx vy vz")
    parser.add_argument("--timestep", type=positive_number, required=True, metavar="DT",
                        help="time step of the run (LAMMPS command timestep)")
    parser.add_argument("--types", type=positive_integer, nargs="+", metavar="TYPE",
                        help="atom types of the cells; needed if there are walls (default: all "
                        "atoms with triangles)")
    parser.add_argument("--start", type=int, metavar="FRAME", help="first frame used, from 0")
    parser.add_argument("--stop", type=int, metavar="FRAME", help="frame to stop before")
    parser.add_argument("--step", type=positive_integer, metavar="N", help="use every Nth frame")
    parser.add_argument("--quiet", action="store_true", help="show no progress")


def add_shear_plane(parser):
    """The argument of the commands that look at shapes."""
    parser.add_argument("--shear-plane", default="xz", metavar="AB",
                        help="flow and gradient direction (default: %(default)s)")


def positive_number(text):
    """Argument type: a number > 0."""
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def positive_integer(text):
    """Argument type: an integer > 0."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not a positive integer")
    return value


def analyse(options, reference=None):
    """Universe and CellShapes of the command's input."""
    system = universe(options.data, options.dump, dt=options.timestep)
    if reference == "data":
        reference = read_reference_shape(options.data, system.atoms.ids)
    shapes = CellShapes(system, shear_plane=options.shear_plane, reference=reference,
                        types=options.types)
    shapes.run(start=options.start, stop=options.stop, step=options.step,
               verbose=not options.quiet)
    return system, shapes


def run_shapes(options):
    """Subcommand shapes."""
    reference = "data" if options.reference == "data" else None
    _, shapes = analyse(options, reference)
    shapes.write_csv(options.out)
    results = shapes.results
    print(f"{options.out}: {len(results.times)} frames of {len(results.molecules)} cells, "
          f"t = {results.times[0]:g} to {results.times[-1]:g}")


def paint_spots(system, shapes, flow, gradient):
    """Spots of the pictures: one per cell, round in the first frame used."""
    from .pictures.paint import make_spots
    positions = get_positions(system.trajectory[int(shapes.frames[0])])
    toward = np.cross(np.eye(3)[flow], np.eye(3)[gradient])
    return make_spots(positions, shapes.mesh, shapes.results.markers, toward)


def run_pictures(options):
    """Subcommand pictures."""
    from . import pictures    # matplotlib takes a second to load; the table does not need it
    system, shapes = analyse(options)
    os.makedirs(options.out, exist_ok=True)
    flow, gradient = (AXIS_NAMES.index(letter) for letter in options.shear_plane)
    chosen = np.unique(np.linspace(0, shapes.n_frames - 1, options.panels).round().astype(int))
    frames = [int(shapes.frames[k]) for k in chosen]
    spots = None if options.no_marker else paint_spots(system, shapes, flow, gradient)

    def make_renderer(seen):
        return pictures.SceneRenderer(system, shapes.mesh, seen, flow, gradient, spots)

    times = shapes.results.times
    for name, draw in (
            ("shapes.png", lambda path: pictures.draw_shapes(
                shapes.results, path, options.shear_plane)),
            ("snapshots.png", lambda path: pictures.draw_snapshots(
                make_renderer(frames), frames, times[chosen], path, options.width // 2)),
            ("final.png", lambda path: pictures.draw_final(
                make_renderer(frames[-1:]), frames[-1], times[-1], path, options.width))):
        path = os.path.join(options.out, name)
        begin = clock.perf_counter()
        draw(path)
        if options.quiet:
            print(path)
        else:
            print(f"{path}  ({clock.perf_counter() - begin:.1f} s)")


def run_profile(options):
    """Subcommand profile."""
    from . import pictures    # as above
    system = universe(options.data, options.dump, dt=options.timestep)
    profile = CrossProfile(system, axis=options.axis, n_bins=options.bins, types=options.types,
                           points=options.points, flow=options.flow)
    profile.run(start=options.start, stop=options.stop, step=options.step,
                verbose=not options.quiet)
    os.makedirs(options.out, exist_ok=True)
    table, picture = (os.path.join(options.out, name) for name in ("profile.csv", "profile.png"))
    profile.write_csv(table)
    pictures.draw_profile(profile.results, picture, options.axis, options.flow)
    print(f"{table}\n{picture}")
