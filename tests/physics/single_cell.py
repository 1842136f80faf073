"""One cell in shear flow through lmp_biem: input script, run, time series of its shape.
Knows no reference values."""

import tempfile

import numpy as np
from lammps_scripts import HEADER, run_script

SCRIPT = HEADER + """region box prism -{half} {half} -{half} {half} -{half} {half} 0 0 0
create_box 1 box angle/types 1 dihedral/types 1
mass 1 1.0
create_cells {shape} nodes {nodes} single 0 0 0
pair_style none
angle_style biem/skalak
angle_coeff 1 {ES} {ED}
dihedral_style biem/bend
dihedral_coeff 1 {EB} sphere
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {timestep}
fix flow all biem viscosity 1.0 accuracy 1e-3 flow shear xz 1.0
compute cell all biem/cell
thermo_style custom step time f_flow[2] c_cell[1][{columns[0]}] c_cell[1][{columns[1]}] &
  c_cell[1][{columns[2]}]
thermo_modify format float %.12g
thermo {every}
run {steps}
"""

# Columns of compute biem/cell: area, in-plane angle of the equivalent ellipsoid (degrees), Taylor
# deformation. RED_CELL has the inclination of the surface tensor instead, as in Zhao et al. 2012.
CAPSULE = (2, 23, 8)
RED_CELL = (2, 6, 8)


def run_single_cell(shape, nodes, ES, ED, EB, timestep, duration, box=12.0, columns=RED_CELL):
    """Returns an array of rows (time, volume error, area, inclination [deg], deformation)."""
    steps = round(duration / timestep)
    every = max(1, steps // 100)
    script = SCRIPT.format(half=0.5 * box, shape=shape, nodes=nodes, ES=ES, ED=ED, EB=EB,
                           timestep=timestep, steps=steps, every=every, columns=columns)
    with tempfile.TemporaryDirectory() as folder:
        output = run_script(script, folder)
    rows = []
    for line in output.splitlines():
        words = line.split()
        try:
            row = [float(word) for word in words]
        except ValueError:
            continue
        if len(row) == 6:
            rows.append(row[1:])
    return np.array(rows)


def average(series, start):
    """Means of all columns from time start on."""
    return series[series[:, 0] >= start].mean(axis=0)
