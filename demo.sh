#!/bin/sh
# From an empty clone to the first picture: installs what is missing, builds lmp_biem, shears red
# cells in a periodic box on two processors, and draws them.  Everything lands in demo_output/.
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
  -log "$output/log.lammps" -var output_dir "$output")

step "Shapes and pictures"
biem_analysis() {
  PYTHONPATH=$top/tools/biem_analysis/src /usr/bin/python3 -m biem_analysis "$@"
}
biem_analysis shapes "$output/cells.data" "$output/cells.dump" --output "$output"
biem_analysis pictures "$output/cells.data" "$output/cells.dump" --output "$output"

step "Done"
echo "These files are yours:"
for file in "$output"/*; do
  case $(basename "$file") in
    log.lammps) what="LAMMPS' log of the run" ;;
    cells.data) what="the cells: nodes, triangles, hinges (LAMMPS data file)" ;;
    cells.dump) what="trajectory of all nodes (LAMMPS dump; MDAnalysis reads it)" ;;
    cells.table) what="volume, area, shape and inclination of each cell in time" ;;
    *.png) what="picture" ;;
    *) what="" ;;
  esac
  printf '  %-40s %s\n' "demo_output/$(basename "$file")" "$what"
done
