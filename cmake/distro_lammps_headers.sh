#!/bin/sh
# Usage: distro_lammps_headers.sh <installed header folder> <target folder>
# Copies the LAMMPS headers that the distribution's -dev package lacks out of the distribution's own
# source package of the same version.  Needs no root.
set -eu

installed=$1
target=$2
here=$(cd "$(dirname "$0")" && pwd)

version=$(dpkg-query -W -f '${source:Version}' liblammps-dev 2>/dev/null) || {
  echo "distro_lammps_headers.sh: the package liblammps-dev is not installed" >&2
  exit 1
}
work=$target.download
trap 'rm -rf "$work"' EXIT
rm -rf "$target" "$work"
mkdir -p "$target" "$work/tree"
archive=$("$here/distro_source.sh" "$work" lammps "$version")
tar -xf "$archive" -C "$work/tree" --wildcards '*src/*.h'
source=$(dirname "$(find "$work/tree" -path '*src/version.h')")

# The installed headers are left alone: the distribution may have patched them.
cd "$source"
for header in *.h fmt/*.h; do
  [ -e "$installed/$header" ] && continue
  mkdir -p "$(dirname "$target/$header")"
  cp "$header" "$target/$header"
done
cp version.h "$target/version.h"
echo "lammps $version" >"$target/complete"
echo "LAMMPS headers out of the source package lammps=$version: $(find "$target" -name '*.h' | wc -l) files"
