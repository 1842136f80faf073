#!/bin/sh
# From an empty clone to the first picture: installs what is missing, builds lmp_biem, shears red
# cells in a periodic box on two processors, and draws them.  Everything lands in demo_output/.
# Arguments go to lmp_biem: ./demo.sh -var steps 40
set -eu
cd "$(dirname "$0")"
top=$PWD
example=$top/examples/sheared_suspension
output=$top/demo_output
started=$(date +%s)

step() { printf '\n== %s (%d s since the start)\n' "$1" $(($(date +%s) - started)); }

step "Packages"
cmake/install_packages.sh build demo
set -a; . cmake/mpi_environment; set +a

step "Building build/lmp_biem"
cmake -S . -B build
cmake --build build --parallel 2 --target lmp_biem

step "Shearing red cells: examples/sheared_suspension/in.sheared_suspension on 2 processors"
rm -rf "$output"
mkdir "$output"
(cd "$example" && mpirun -np 2 "$top/build/lmp_biem" -in in.sheared_suspension \
  -log "$output/log.lammps" -var output_dir "$output" "$@")

step "Shapes and pictures"
timestep=$(awk '$1 == "timestep" && $2 ~ /^[0-9.]/ { value = $2 } END { print value }' \
  "$output/log.lammps")
biem_analysis() {
  PYTHONPATH=$top/tools/biem_analysis/src /usr/bin/python3 -m biem_analysis "$1" \
    --data "$output/cells.data" --dump "$output/cells.dump" --timestep "$timestep" --out "$2"
}
biem_analysis shapes "$output/shapes.csv"
biem_analysis pictures "$output"

step "Done"
echo "What is there now:"
describe() {
  [ -e "demo_output/$1" ] || { echo "demo_output/$1 was not written" >&2; return 1; }
  printf '  demo_output/%-15s %s\n' "$1" "$2"
}
describe final.png "picture: the cells at the end of the run"
describe snapshots.png "picture: the cells at several times"
describe shapes.png "picture: inclination and deformation of the cells against time"
describe shapes.csv "table: shape of every cell at every frame (biem-analysis)"
describe cells.table "table: mean volume, area and shape in time (LAMMPS, fix ave/time)"
describe cells.data "the cells: nodes, triangles, hinges (LAMMPS data file)"
describe cells.dump "trajectory of all nodes (LAMMPS dump; MDAnalysis reads it)"
describe log.lammps "LAMMPS' log of the run, with the chosen numerical parameters"
