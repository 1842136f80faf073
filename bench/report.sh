#!/bin/sh
# Measures speed beside error and regenerates every CSV file, table and plot of doc/speed-vs-error.
#   bench/report.sh                 everything; takes about ten minutes on two idle cores
#   bench/report.sh --quick         at most 10^4 points, about a minute; the page it writes is
#                                   <build>/speed-vs-error/README.md, that of doc/ stays
#   bench/report.sh --draw          no measurement: tables and plots from the CSV files of doc/
#   --build FOLDER                  build folder (build-bench)
set -eu
top=$(cd "$(dirname "$0")/.." && pwd)
build=$top/build-bench
mode=full
while [ $# -gt 0 ]; do
  case $1 in
    --quick) mode=quick ;;
    --draw) mode=draw ;;
    --build) shift; build=$(mkdir -p "$1" && cd "$1" && pwd) ;;
    *) echo "usage: bench/report.sh [--quick | --draw] [--build FOLDER]" >&2; exit 2 ;;
  esac
  shift
done
set -a; . "$top/cmake/mpi_environment"; set +a
page=$top/doc/speed-vs-error
started=$(date +%s)
step() { printf '== %s (%d s since the start)\n' "$1" $(($(date +%s) - started)); }
draw() { /usr/bin/python3 "$top/bench/report.py" "$page"; }

if [ $mode = draw ]; then
  draw
  exit
fi

step "Building"
mkdir -p "$build"
log=$build/report.log
cmake -S "$top" -B "$build" -DBIEM_BUILD_BENCH=on -DBIEM_BUILD_TESTS=off >"$log" 2>&1 &&
  cmake --build "$build" --parallel 2 --target ewald suspension near_triangle_bench lmp_biem \
    >>"$log" 2>&1 || { tail -n 30 "$log" >&2; exit 1; }
if [ $mode = quick ]; then
  page=$build/speed-vs-error
  mkdir -p "$page"
  cp "$top/doc/speed-vs-error/README.md" "$page"
fi
results=$page/results
mkdir -p "$results"

# ewald or suspension on a number of ranks: measure FILE RANKS PROGRAM ARGUMENTS...
# The first measurement of a file writes it, later ones are appended.
measure() {
  file=$results/$1; n_ranks=$2; program=$3
  shift 3
  if [ "$file" = "${last-}" ]; then header=--no-header; else header=; : >"$file"; fi
  last=$file
  if [ "$n_ranks" = 1 ]; then
    "$build/bench/$program" "$@" $header >>"$file"
  else
    mpirun -np "$n_ranks" "$build/bench/$program" "$@" $header >>"$file"
  fi
}
all=1e-2,1e-3,1e-4,1e-5,1e-6,1e-7,1e-8
five=1e-2,1e-3,1e-4,1e-6,1e-8
three=SL,DL,SL+DL

step "Error against time"
if [ $mode = quick ]; then
  measure error_time.csv 1 ewald --n 1000,10000 --kernel $three --tolerance $five \
    --targets 50 --seconds 0.1
else
  measure error_time.csv 1 ewald --n 1000,10000 --kernel $three --tolerance $all --targets 200
  measure error_time.csv 1 ewald --n 100000 --kernel $three --tolerance $all --targets 30 \
    --seconds 1
  measure error_time.csv 1 ewald --n 1000000 --kernel $three --tolerance $five --targets 10 \
    --seconds 1
fi

step "Time against the number of points"
[ $mode = quick ] && numbers=512,4096 || numbers=1000,8000,64000,512000
measure scaling.csv 1 ewald --n $numbers --kernel SL,SL+DL --tolerance 1e-3,1e-6 --targets 0

step "One and two ranks"
[ $mode = quick ] && numbers=10000 || numbers=10000,100000
for n_ranks in 1 2; do
  measure ranks.csv $n_ranks ewald --n $numbers --kernel SL,SL+DL --tolerance 1e-3,1e-6 --targets 10
done

# No times are taken from here: both splits at once.
step "Requested and measured error"
[ $mode = quick ] && tolerances=1e-2,1e-4,1e-6 || tolerances=$all
[ $mode = quick ] && numbers=1000 || numbers=8000
for split in pswf spme; do
  "$build/bench/ewald" --n $numbers --kernel $three --split $split --tolerance $tolerances \
    --cell cubic,orthogonal,sheared,triclinic --points random,cells-random,cells-smooth,corner \
    --repeat 1 --targets 60 >"$results/accuracy_$split.csv" &
  eval "process_$split=\$!"
done
wait "$process_pswf"
wait "$process_spme"

step "A suspension of red cells"
[ $mode = quick ] && cells=2 || cells=3
for n_ranks in 1 2; do
  measure suspension.csv $n_ranks suspension --cells $cells
done

step "Blocks of the coupled system"
[ $mode = quick ] && blocks="--cells 2 --nodes 162" || blocks="--cells 8 --nodes 642"
/usr/bin/python3 "$top/bench/blocks.py" --lmp "$build/lmp_biem" $blocks >"$results/blocks.csv"

step "Near field"
"$build/bench/near_triangle_bench" --benchmark_min_time=0.1 --benchmark_format=json \
  >"$build/near_triangle.json"
/usr/bin/python3 "$top/bench/report_near.py" "$build/near_triangle.json" \
  "$results/near_triangle.csv"

/usr/bin/python3 "$top/bench/report_machine.py" "$build" "$results/machine.csv"
step "Tables and plots"
draw
step "Done: $page/README.md"
