#!/bin/sh
# Builds the package and runs its tests.
#   ./test.sh            every test but those that take long
#   ./test.sh --full     these, too: longer runs, and builds against other LAMMPS versions
set -eu
cd "$(dirname "$0")"

case ${1-} in
  "") selection="-LE full" ;;
  --full) selection= ;;
  *) echo "usage: ./test.sh [--full]" >&2; exit 2 ;;
esac

cmake/install_packages.sh build test
set -a; . cmake/mpi_environment; set +a

cmake -S . -B build -DBIEM_BUILD_TESTS=ON
cmake --build build --parallel 2
cd build
exec ctest --parallel 2 --output-on-failure $selection
