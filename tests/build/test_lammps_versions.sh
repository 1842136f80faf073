#!/bin/sh
# Usage: test_lammps_versions.sh <work folder> [<Debian release> ...]
# Builds the package into LAMMPS 29Sep2021, 4Feb2025 and 4Jul2026 and as a plugin for each, runs
# in.versions with all of them, and compares the numbers.  The sources are those of the source
# packages of three Debian releases (bookworm, trixie, forky); where they cannot be had the test is
# skipped (exit status 77).
# The first run builds LAMMPS three times (minutes each); later runs in the same folder do not.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
repository=$(cd "$here/../.." && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
shift
suites=${*:-bookworm trixie forky}
set -a; . "$repository/cmake/mpi_environment"; set +a

fail() { echo "FAILED: $*" >&2; exit 1; }

get_sources() {
  suite=$1
  [ -d "$work/$suite/tree/cmake" ] && return 0
  archive=$("$repository/cmake/distro_source.sh" "$work/$suite/download" lammps newest "$suite") ||
    return 1
  mkdir -p "$work/$suite/unpacked"
  tar -xf "$archive" -C "$work/$suite/unpacked"
  version_file=$(find "$work/$suite/unpacked" -path '*src/version.h')
  mv "$(dirname "$(dirname "$version_file")")" "$work/$suite/tree"
  rm -rf "$work/$suite/download" "$work/$suite/unpacked"
}

build() {
  suite=$1
  tree=$work/$suite/tree
  cmake -S "$repository" -B "$work/$suite/build" -DLAMMPS_SOURCE_DIR="$tree" -DPKG_PLUGIN=ON \
    -DBIEM_BUILD_TESTS=OFF
  cmake --build "$work/$suite/build" --parallel 2 --target lmp_biem
  cmake -S "$repository" -B "$work/$suite/plugin" -DLAMMPS_HEADER_DIR="$tree/src" -DBIEM_PLUGIN=ON \
    -DBIEM_BUILD_TESTS=OFF
  cmake --build "$work/$suite/plugin" --parallel 2
}

run() {
  suite=$1
  name=$2
  shift 2
  (cd "$work/$suite" && mpirun -np 2 build/lmp_biem -in "$here/in.versions" -log "$name.log" \
    -screen none "$@") || { tail -n 20 "$work/$suite/$name.log"; fail "$suite: in.versions ($name)"; }
  sed -n 's/^result //p' "$work/$suite/$name.log" >"$work/$suite/$name.result"
  [ -s "$work/$suite/$name.result" ] || fail "$suite: $name.log has no line that begins with: result"
}

# Every number of two result lines, to a relative 1e-9.
compare() {
  paste -d ' ' "$1" "$2" | awk '{
    for (i = 1; i <= NF / 2; i++) {
      a = $i; b = $(i + NF / 2); d = a - b; if (d < 0) d = -d; s = a < 0 ? -a : a
      if (d > 1e-9 * s + 1e-14) { print "differ: " a " " b; exit 1 } } }'
}

refuses_other_version() {
  built_for=$1
  running=$2
  log=$work/$running/refusal.log
  plugin=$work/$built_for/plugin/biemplugin.so
  printf 'plugin load %s\nangle_style biem/skalak\n' "$plugin" >"$work/$running/in.refusal"
  if (cd "$work/$running" && mpirun -np 1 build/lmp_biem -in in.refusal -log none) >"$log" 2>&1; then
    cat "$log"
    fail "the LAMMPS of $running took the plugin that was built for that of $built_for"
  fi
  grep -Eq 'was built for LAMMPS|Open of file .* failed' "$log" || { cat "$log"; fail "no clear refusal"; }
}

available=
for suite in $suites; do
  if get_sources "$suite"; then
    available="$available $suite"
  else
    echo "The sources of LAMMPS in $suite cannot be had here; going on without."
  fi
done
[ -n "$available" ] || { echo "SKIPPED: no LAMMPS sources can be had here."; exit 77; }

first=
for suite in $available; do
  build "$suite"
  run "$suite" built_in
  run "$suite" plugin -var use_plugin yes -var plugin "$work/$suite/plugin/biemplugin.so"
  echo "$(grep -h 'define LAMMPS_VERSION' "$work/$suite/tree/src/version.h"):" \
    "$(cat "$work/$suite/built_in.result")"
  first=${first:-$suite}
  compare "$work/$first/built_in.result" "$work/$suite/built_in.result" || fail "$first and $suite"
  compare "$work/$first/built_in.result" "$work/$suite/plugin.result" || fail "$suite: plugin"
  [ "$first" = "$suite" ] || refuses_other_version "$first" "$suite"
done
echo "passed:$available"
