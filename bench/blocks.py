"""What each block of the coupled system costs in a step, beside the error: CSV on standard output.

    bench/blocks.py --lmp build/lmp_biem [--cells 8] [--nodes 642] [--steps 20]

Scenes from one single layer to everything at once, in the same box, with the same cells. Times are
CPU milliseconds per step of one process, over the steps after the first ten. The error is that of
the nodes' velocities relative to the background flow, against the same scene at accuracy 1e-7.
"""

import argparse
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ACCURACIES = (1e-2, 1e-3, 1e-4)
REFERENCE = 1e-7
SKIPPED = 10    # steps in which the start is forgotten

SCRIPT = """
units lj
newton on
atom_style molecular
atom_modify map yes
boundary p p p
region box block 0 {length} 0 {length} 0 {length}
create_box 3 box angle/types 2 dihedral/types 1
mass * 1.0
{walls}
create_cells rbc nodes {nodes} random {cells} 4711 gap 0.05 group cells
{particles}
pair_style none
angle_style hybrid biem/skalak zero
angle_coeff 1 biem/skalak 2.0 100.0
angle_coeff 2 zero
dihedral_style biem/bend
dihedral_coeff 1 0.0066 sphere
neighbor 0.1 bin
timestep 0.001
fix flow all biem viscosity 1.0 accuracy {accuracy} flow {flow} cells cells viscosity/ratio {ratio} &
  {groups}
variable u atom f_flow[1]
variable forces equal f_flow[7]+f_flow[8]+f_flow[9]-f_flow[13]
thermo_style custom step cpu v_forces f_flow[13] f_flow[11]
thermo 1
dump d all custom 1 velocity.dump id f_flow[1] f_flow[2] f_flow[3]
dump_modify d sort id format float %.12g
run 0
undump d
run {steps}
"""

WALLS = "create_wall plane z 0 edge 0.25 type 2 angle_type 2 group walls"
PARTICLES = ("create_cells platelet diameter 0.993 thickness 0.248 nodes 162 random 4 815 gap 0.05 "
             "type 3 angle_type 2 group platelets")
# Name, walls, particles, viscosity ratio of the cells.
SCENES = (("cells", False, False, 1), ("cells, walls", True, False, 1),
          ("cells, platelets", False, True, 1), ("cells, platelets, walls", True, True, 1),
          ("cells of ratio 5", False, False, 5),
          ("cells of ratio 5, platelets, walls", True, True, 5))


def make_script(scene, accuracy, options):
    _, has_walls, has_particles, ratio = scene
    groups = ("wall walls " if has_walls else "") + ("rigid platelets" if has_particles else "")
    # Hematocrit 0.2.
    length = (options.cells * 4.18879 / 0.2) ** (1.0 / 3.0)
    return SCRIPT.format(walls=WALLS if has_walls else "",
                         particles=PARTICLES if has_particles else "", ratio=ratio,
                         groups=groups, accuracy=accuracy, length=length, nodes=options.nodes,
                         cells=options.cells, steps=SKIPPED + options.steps,
                         flow="mean 1 0 0" if has_walls else "none")


def run(script, lmp, folder):
    """Thermo rows of the last run, the first row of all, and the velocities (n x 3) of that."""
    (folder / "in.blocks").write_text(script)
    done = subprocess.run([lmp, "-in", "in.blocks", "-log", "none"], cwd=folder, text=True,
                          capture_output=True)
    if done.returncode:
        raise SystemExit(f"blocks: {lmp} failed:\n{done.stdout[-2000:]}{done.stderr[-500:]}")
    rows, first = [], None
    for line in done.stdout.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            first, rows = first or (rows[0] if rows else None), []
        elif len(words) == 5 and words[0].isdigit():
            rows.append([float(w) for w in words])
    dump = (folder / "velocity.dump").read_text().split("ITEM: ATOMS")[1].splitlines()[1:]
    return np.array(rows), first, np.array([line.split()[1:] for line in dump], dtype=float)


def measure(scene, options, folder):
    lmp = str(Path(options.lmp).resolve())
    exact = run(make_script(scene, REFERENCE, options), lmp, folder)[2]
    for accuracy in ACCURACIES:
        rows, first, velocity = run(make_script(scene, accuracy, options), lmp, folder)
        start, end = rows[SKIPPED], rows[-1]
        per_step = 1e3 * (end - start) / (end[0] - start[0])
        error = np.linalg.norm(velocity - exact) / np.linalg.norm(exact)
        yield {"scene": scene[0], "accuracy": accuracy, "error": f"{error:.3e}",
               "wall_ms": f"{per_step[1]:.4g}", "forces_ms": f"{per_step[2]:.4g}",
               "coupled_ms": f"{per_step[3]:.4g}",
               "iterations": f"{rows[SKIPPED + 1:, 4].mean():.3g}",
               "cold_iterations": int(first[4])}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--lmp", required=True)
    parser.add_argument("--cells", type=int, default=8)
    parser.add_argument("--nodes", type=int, default=642)
    parser.add_argument("--steps", type=int, default=20)
    options = parser.parse_args()
    writer = None
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            for row in measure(scene, options, Path(folder)):
                if writer is None:
                    writer = csv.DictWriter(sys.stdout, row.keys())
                    writer.writeheader()
                writer.writerow(row)
                sys.stdout.flush()


if __name__ == "__main__":
    main()
