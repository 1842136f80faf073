"""Small scenes of cells, rigid particles and walls: parts of input scripts.
Builds on flow_cases.py; knows nothing of what is tested."""

import flow_cases as flow
from lammps_scripts import HEADER

START = HEADER + """neighbor {skin!r} bin
region box prism 0 {box[0]!r} 0 {box[1]!r} 0 {box[2]!r} 0 {tilt!r} 0
create_box 3 box angle/types 2 dihedral/types 1 extra/angle/per/atom 6 extra/dihedral/per/atom 6
mass * 1.0
"""

# Membranes have angle type 1, particles and walls angle type 2 without forces.
STYLES = """pair_style none
angle_style hybrid biem/skalak zero
angle_coeff 1 biem/skalak 2.0 20.0
angle_coeff 2 zero
dihedral_style biem/bend
dihedral_coeff * 0.01 sphere
"""


def make_header(box=(6.0, 6.0, 6.0), tilt=0.0, skin=0.2):
    return START.format(box=box, tilt=tilt, skin=skin)


def make_body(shape, center, group, nodes=42, angle_type=1, more=""):
    """One surface made by create_cells, in a group."""
    x, y, z = center
    return (f"create_cells {shape} nodes {nodes} single {x} {y} {z} group {group} "
            f"angle_type {angle_type} {more}\n")


def make_particle(center, group="balls", shape="sphere", nodes=42, more=""):
    return make_body(shape, center, group, nodes, 2, more)


def make_wall(height=0.0, edge=0.75, group="walls", axis="z"):
    return f"create_wall plane {axis} {height!r} edge {edge!r} group {group} type 2 angle_type 2\n"


def make_points(points, group="points"):
    """Single atoms that are on no surface."""
    lines = [f"create_atoms 3 single {x} {y} {z}\n" for x, y, z in points]
    return "".join(lines) + f"group {group} type 3\n"


def make_fix(surfaces, kind="none", accuracy=1e-3, timestep=0.004, more=""):
    """surfaces: keywords with groups."""
    return flow.make_flow(kind, accuracy, timestep=timestep, more=f"{surfaces} {more}")
