"""Scenes of the coupled system and the GMRES iterations that they take: input scripts, runs,
averages. Knows no bounds."""

import tempfile
from typing import NamedTuple

import numpy as np

from lammps_scripts import HEADER
from styles import membrane_cases as cases

START = HEADER + """region box {box}
create_box 3 box angle/types 2 dihedral/types 2 extra/angle/per/atom 6 extra/dihedral/per/atom 6
mass * 1.0
{create}
pair_style none
angle_style hybrid biem/skalak zero
angle_coeff 1 biem/skalak {shear} 100.0
angle_coeff 2 zero
dihedral_style hybrid biem/bend zero
dihedral_coeff 1 biem/bend 0.0066 sphere
dihedral_coeff 2 zero
neighbor 0.1 bin
timestep {timestep}
fix b all biem viscosity 1.0 accuracy 1e-3 solver/tolerance 1e-4 flow {flow}
thermo_style custom step f_b[11] f_b[12] f_b[13]
thermo 1
run {steps}
"""
RIGID = "type 2 angle_type 2 dihedral_type 2"
PLATELET = "platelet diameter 0.993 thickness 0.248 nodes 162"
HEMATOCRIT = 0.2


class Count(NamedTuple):
    """Iterations of a run."""

    cold: float    # of the first evaluation, which starts from zero
    warm: float    # mean over the steps after the start
    most: float    # largest of these steps


def count_iterations(create, flow, box="block 0 8 0 6 0 6", timestep=0.004, steps=16, shear=2.0,
                     skip=6):
    """Count of a scene; `skip` steps belong to the start."""
    script = START.format(create=create, flow=flow, box=box, timestep=timestep, steps=steps,
                          shear=shear)
    with tempfile.TemporaryDirectory() as folder:
        rows = cases.run_thermo(script, folder)
    iterations = np.array([row["f_b[11]"] for row in rows])
    return Count(iterations[0], iterations[skip:].mean(), iterations[skip:].max())


def get_timestep(nodes):
    """A stable time step for cells of 162 or 642 nodes."""
    return 0.004 if nodes <= 162 else 0.002


def channel(n_cells=4, nodes=162, edge=0.4, n_platelets=2, length=8.0, ratio=1.0):
    """Cells and platelets in a channel of height 6, mean velocity 2."""
    create = (f"create_wall plane z 0 edge {edge} group walls type 3 angle_type 2\n"
              f"create_cells rbc nodes {nodes} random {n_cells} 111 gap 0.1 group cells\n")
    flow = f"mean 2.0 0 0 wall walls cells cells viscosity/ratio {ratio}"
    if n_platelets > 0:
        create += f"create_cells {PLATELET} random {n_platelets} 555 gap 0.1 group plts {RIGID}\n"
        flow += " rigid plts"
    return count_iterations(create, flow, f"block 0 {length} 0 6 0 6", 0.5 * get_timestep(nodes))


def suspension(ratio, n_cells=4, nodes=162):
    """Cells at a hematocrit of 0.2 in shear."""
    side = (n_cells * 4.0 * np.pi / 3.0 / HEMATOCRIT) ** (1.0 / 3.0)
    create = f"create_cells rbc nodes {nodes} random {n_cells} 17 gap 0.05 group cells"
    return count_iterations(create, f"shear xz 1.0 cells cells viscosity/ratio {ratio}",
                            f"prism 0 {side} 0 {side} 0 {side} 0 0 0", get_timestep(nodes))


def single(ratio, nodes=162):
    """One cell in shear, in a box of 8."""
    return count_iterations(f"create_cells rbc nodes {nodes} single 4 4 0 group cells",
                            f"shear xz 1.0 cells cells viscosity/ratio {ratio}",
                            "prism 0 8 0 8 -4 4 0 0 0", get_timestep(nodes))


def pair(kind, gap=0.01, nodes=162):
    """Two unit spheres with a small gap, pressed together by shear: rigid, or capsules; box of 8.

    Each has a node at its pole, and the two nodes are the gap apart.
    """
    outside = {162: 1.011475, 642: 1.002866}[nodes]    # of the nodes: create_cells sets the volume
    x, z = np.cos(np.radians(120.0)), np.sin(np.radians(120.0))
    half = outside + 0.5 * gap
    style = RIGID if kind == "rigid" else ""
    create = "".join(f"create_cells sphere nodes {nodes} single {4 + s * half * x} 4 "
                     f"{s * half * z} orientation {x} 0 {z} group balls {style}\n"
                     for s in (1, -1))
    surface = "rigid balls" if kind == "rigid" else f"cells balls viscosity/ratio {kind}"
    return count_iterations(create, f"shear xz 1.0 {surface}", "prism 0 8 0 8 -4 4 0 0 0",
                            0.5 * get_timestep(nodes))
