#!/bin/sh
# Usage: distro_source.sh <target folder> <source package> <version> [<suite>]
# Fetches the .orig archive of a source package of the distribution into the target folder and prints
# its path.  Version: as apt writes it, or "newest".  Suite: another one of the same distribution, for
# example trixie; without it, those of this machine.  Uses the mirrors this machine already has, keeps
# its apt lists in the target folder, needs no root and leaves the system's settings as they are.
set -eu

mkdir -p "$1"
work=$(cd "$1" && pwd)
package=$2
version=$3
suite=${4-}

fail() { echo "distro_source.sh: $*" >&2; exit 1; }

command -v apt-get >/dev/null || fail "apt-get is not here; only Debian and its relatives are known"
rm -rf "$work/parts" "$work/lists" "$work/archives"
mkdir -p "$work/parts" "$work/lists/partial" "$work/archives/partial"

# Source entries out of the binary ones, for both formats that apt knows.
for file in /etc/apt/sources.list.d/*.sources; do
  [ -f "$file" ] && sed 's/^Types:.*/Types: deb-src/' "$file" >"$work/parts/$(basename "$file")"
done
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  [ -f "$file" ] && sed -n 's/^deb /deb-src /p' "$file" \
    >"$work/parts/$(basename "$file" .list)-source.list"
done

# Another suite: keep only the entries of this release itself (not -updates, -security, or other
# software) and put the other suite's name in its place.
if [ -n "$suite" ]; then
  codename=$(. /etc/os-release && echo "${VERSION_CODENAME-}")
  [ -n "$codename" ] || fail "/etc/os-release does not name this release, so $suite cannot be found"
  for file in "$work"/parts/*.sources; do
    [ -f "$file" ] || continue
    awk -v own="$codename" -v other="$suite" 'BEGIN { RS = ""; ORS = "\n\n" }
      $0 ~ "(^|\n)Suites:[^\n]*[ ]" own "([ \n]|$)" { sub(/Suites:[^\n]*/, "Suites: " other); print }
      ' "$file" >"$file.new" && mv "$file.new" "$file"
  done
  for file in "$work"/parts/*.list; do
    [ -f "$file" ] || continue
    sed -n "s/^\(.*\) $codename \(.*\)$/\1 $suite \2/p" "$file" >"$file.new" && mv "$file.new" "$file"
  done
fi

run_apt() {
  command=$1
  shift
  "$command" -qq -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/parts" \
    -o Dir::State::Lists="$work/lists" -o Dir::Cache="$work" -o APT::Get::List-Cleanup=0 \
    -o APT::Sandbox::User="$(id -un)" "$@"
}

# A mirror of other software that has no sources must not stop us: the next commands decide.
run_apt apt-get update >"$work/log" 2>&1 || true
if [ "$version" = newest ]; then
  version=$(run_apt apt-cache showsrc "$package" 2>>"$work/log" | sed -n 's/^Version: //p' |
    sort -V | tail -n 1)
  [ -n "$version" ] || fail "no source package $package in ${suite:-the suites of this machine}"
fi
(cd "$work/archives" && run_apt apt-get source --download-only --tar-only "$package=$version") \
  >>"$work/log" 2>&1 || {
  grep -E '^(E|W|Err)' "$work/log" | head -n 10 >&2
  fail "apt-get could not fetch the source package $package=$version"
}
for archive in "$work"/archives/*.orig.tar.*; do
  [ -f "$archive" ] && echo "$archive" && exit 0
done
fail "the source package $package=$version has no .orig archive"
