#!/bin/sh
# Usage: cmake/install_packages.sh <group> ...      groups: build demo test
# Installs the distribution's packages that the groups need and this machine lacks, and says which.
# Does nothing, and needs no rights, when all are there.  Uses sudo when not root.
set -eu

packages_of() {
  case $1 in
    build) echo g++ make cmake xz-utils lammps liblammps-dev openmpi-bin libopenmpi-dev \
                libeigen3-dev libfftw3-dev ;;
    demo) echo python3-mdanalysis python3-matplotlib ;;
    test) echo libgtest-dev python3-mdanalysis python3-matplotlib ;;
    *) echo "install_packages.sh: unknown group '$1'; known: build demo test" >&2; return 1 ;;
  esac
}

is_installed() {
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "This machine has no apt: nothing is installed.  Needed are a C++17 compiler, CMake, Open MPI," \
       "FFTW, Eigen, LAMMPS as a library, GoogleTest, MDAnalysis, matplotlib." >&2
  exit 0
fi

missing=
for group in "$@"; do
  packages=$(packages_of "$group")
  for package in $packages; do
    is_installed "$package" && continue
    case " $missing " in *" $package "*) ;; *) missing="$missing $package" ;; esac
  done
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "These packages are missing:$missing" >&2
    echo "You are not root and there is no sudo.  As root: apt-get install$missing" >&2
    exit 1
  fi
  as_root="sudo"
fi
echo "Installing from the distribution:$missing"
# A list of some other software that cannot be refreshed is no reason to stop; the install decides.
$as_root apt-get -qq update ||
  echo "Some package lists could not be refreshed; going on with those that are here." >&2
$as_root env DEBIAN_FRONTEND=noninteractive \
  apt-get -qq -y --no-install-recommends install $missing >/dev/null || {
  echo "apt-get could not install:$missing (its messages stand above)" >&2
  exit 1
}
