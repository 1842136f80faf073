#!/bin/sh
# Makes the reference logs of examples anew, on one and two processors:
#   ./make_logs.sh channel_small duct_small      all inputs in these folders
# The program is build/lmp_biem, or what the variable BIEM_LMP names. What the runs write goes to a
# temporary folder. LC_ALL=C keeps the month in English.
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || { echo "usage: $0 example ..." >&2; exit 2; }
program=${BIEM_LMP:-$PWD/../build/lmp_biem}
set -a; . ../cmake/mpi_environment; set +a
day=$(LC_ALL=C date +%d%b%y)
output=$(mktemp -d)
trap 'rm -rf "$output"' EXIT

for example in "$@"; do
  for input in "$example"/in.*; do
    name=${input##*/in.}
    for n in 1 2; do
      (cd "$example" && mpirun -np $n "$program" -in "in.$name" -screen none \
        -log "$output/log" -var output_dir "$output")
      rm -f "$example"/log.*."$name".g++.$n
      sed "s|$output|.|g" "$output/log" >"$example/log.$day.$name.g++.$n"
      echo "$example/log.$day.$name.g++.$n"
    done
  done
done
