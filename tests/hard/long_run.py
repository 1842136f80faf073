"""Drift over a long run: eight red cells in shear, hematocrit 0.2, Ca 1; CSV and picture.

    tests/hard/long_run.py --lmp build/lmp_biem --folder WORK [--nodes 162] [--end 100]
                           [--csv FILE] [--picture FILE]

Runs in pieces of 10 time units with a restart file after each, in WORK: a driver that was stopped
goes on from the last piece. Energy: the flow does the work rate * S_xz on the cells in a unit of
time (S: stresslet of the membrane forces, sum over the cells). It is dissipated by the disturbance
flow (power f_flow) or stored in membranes and contacts (pe), so
    rate * integral of S_xz dt = integral of f_flow dt + pe(t) - pe(0).
"""

import argparse
import csv
import os
from pathlib import Path

import numpy as np

HEMATOCRIT, CELLS = 0.2, 8
PIECE = 10.0

os.environ.setdefault("OMP_NUM_THREADS", "1")

SIDE = float((CELLS * 4.18879 / HEMATOCRIT) ** (1.0 / 3.0))
START = """units lj
newton on
atom_style molecular
atom_modify map yes
boundary p p p
region box prism 0 {side!r} 0 {side!r} 0 {side!r} 0 0 0
create_box 1 box angle/types 1 dihedral/types 1
mass * 1.0
create_cells rbc nodes {nodes} random {cells} 4711 gap 0.05
"""
CONTINUED = """units lj
newton on
atom_modify map yes
read_restart {restart}
"""
REST = """neighbor 0.2 bin
pair_style biem/contact 0.05
pair_coeff * * 50.0
angle_style biem/skalak
angle_coeff * 1.0 100.0
dihedral_style biem/bend
dihedral_coeff * 3.3e-3 sphere
timestep {timestep!r}
fix flow all biem viscosity 1.0 accuracy 1e-3 flow shear xz 1.0 stepper {stepper} {more}
compute cell all biem/cell
variable t equal f_flow[28]
{stress}
thermo_style custom step f_flow[28] pe f_flow v_stress f_flow[2] f_flow[24] f_flow[30]
thermo_modify format float %.12g norm no
thermo 1
write_data cells.data nocoeff nofix
dump d all custom {every} part.dump id mol type xu yu zu
dump_modify d sort id format float %.12g
fix end all halt 1 v_t >= {end!r} error continue
run 100000000
write_restart {next}
"""
NAMES = ("step", "time", "energy", "power", "input", "volume", "evaluations", "repeated")
COLUMNS = ("time", "volume_error", "area_change", "smallest_angle", "energy", "power", "input",
           "work", "dissipated", "stored", "defect")


def run_piece(options, index, scenes):
    """Thermo rows and frames of one piece."""
    folder, end = options.folder, min(options.end, PIECE * (index + 1))
    head = (START.format(side=SIDE, nodes=options.nodes, cells=CELLS) if index == 0 else
            CONTINUED.format(restart=f"restart.{index - 1}"))
    terms = "+".join(f"c_cell[{m}][21]" for m in range(1, CELLS + 1))
    script = head + REST.format(timestep=options.timestep, stepper=options.stepper,
                                more=options.more, stress=f'variable stress equal "{terms}"',
                                every=max(1, round(1.0 / options.timestep)),
                                end=end * (1.0 - 1e-9), next=f"restart.{index}")
    outcome = scenes.run(script, folder)
    if outcome.status != 0:
        raise SystemExit(f"long_run: stopped before t = {end:g}: {outcome.error}")
    return np.column_stack(list(outcome.read_rows(NAMES).values()))


def measure_frames(folder, rows, first, measures):
    """{time: (volume error, area change, smallest angle)}; first: those of the start."""
    frames = measures.read_frames(folder / "part.dump")
    surfaces = measures.Surfaces(frames[0], measures.read_triangles(folder / "cells.data"))
    times = {int(row[0]): row[1] for row in rows}
    found = {}
    for frame in frames:
        x = frame.positions
        values = np.array([(measures.compute_volume(x, t), measures.compute_areas(x, t).sum(),
                            measures.compute_smallest_angle(x, t))
                           for t in surfaces.triangles.values()])
        if first is None:
            first = values
        change = np.abs(values[:, :2] / first[:, :2] - 1.0).max(axis=0)
        found[times[frame.step]] = (*change, values[:, 2].min())
    return found, first


def compute_balance(rows):
    """Time, work done by the flow, energy dissipated, energy stored, all since the start."""
    time, energy, power, work = (rows[:, NAMES.index(n)] for n in
                                 ("time", "energy", "power", "input"))

    def integral(values):
        return np.concatenate(([0.0], np.cumsum(np.diff(time) * 0.5 * (values[1:] + values[:-1]))))

    return time, integral(work), integral(power), energy - energy[0]


def write_csv(path, rows, found):
    time, work, dissipated, stored = compute_balance(rows)
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for t, values in sorted(found.items()):
            i = int(np.argmin(np.abs(time - t)))
            defect = (work[i] - dissipated[i] - stored[i]) / max(work[i], 1e-30)
            numbers = (t, *values, rows[i, 2], rows[i, 3], rows[i, 4], work[i], dissipated[i],
                       stored[i], defect)
            writer.writerow([f"{number:.6g}" for number in numbers])


def draw(csv_path, picture):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    with open(csv_path, newline="") as file:
        rows = list(csv.DictReader(file))
    data = {name: np.array([float(row[name]) for row in rows]) for name in COLUMNS}
    panels = (("volume error", ("volume_error",)), ("area change", ("area_change",)),
              ("smallest angle [deg]", ("smallest_angle",)),
              ("energy rates", ("input", "power")), ("balance defect / work", ("defect",)))
    figure, axes = plt.subplots(2, 3, figsize=(12, 6.4), constrained_layout=True)
    axes = axes.ravel()
    axes[-1].set_axis_off()
    for axis, (title, names) in zip(axes, panels):
        for name in names:
            axis.plot(data["time"], data[name], label=name)
        axis.set_title(title)
        axis.set_xlabel("time")
        axis.grid(alpha=0.3)
    axes[0].set_yscale("log")
    axes[3].legend()
    figure.savefig(picture, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--lmp", required=True)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--nodes", type=int, default=162)
    parser.add_argument("--end", type=float, default=100.0)
    parser.add_argument("--timestep", type=float, default=0.05)
    parser.add_argument("--stepper", default="rkc2")
    parser.add_argument("--more", default="", help="further keywords of fix biem")
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    os.environ["BIEM_LMP"] = str(Path(options.lmp).resolve())
    import hard_measures as measures
    import hard_scene as scenes

    options.folder.mkdir(parents=True, exist_ok=True)
    all_rows, found, first = [], {}, None
    for index in range(int(np.ceil(options.end / PIECE - 1e-9))):
        store = options.folder / f"piece.{index}.npz"
        if not (store.exists() and (options.folder / f"restart.{index}").exists()):
            rows = run_piece(options, index, scenes)
            piece, first = measure_frames(options.folder, rows, first, measures)
            np.savez(store, rows=rows, first=first, times=list(piece), values=list(piece.values()))
        data = np.load(store)
        first, rows = data["first"], data["rows"]
        found.update(zip(data["times"], map(tuple, data["values"])))
        all_rows.append(rows if index == 0 else rows[1:])
        path = options.csv or options.folder / "long_run.csv"
        write_csv(path, np.vstack(all_rows), found)
        draw(path, options.picture or options.folder / "long_run.png")
        print(f"t = {rows[-1, 1]:.4g}: {path.read_text().splitlines()[-1]}", flush=True)


if __name__ == "__main__":
    main()
