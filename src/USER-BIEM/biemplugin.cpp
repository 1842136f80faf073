// The plugin biemplugin.so: hands the styles of the package to `plugin load` of a LAMMPS with the
// PLUGIN package.  It must have been built with the headers of that very LAMMPS.  Knows no physics.
#include "biem_lammps_styles.h"

#include "lammpsplugin.h"
#include "library.h"
#include "version.h"

#include "command.h"

#include <mpi.h>

#include <cstdio>
#include <cstring>

using namespace LAMMPS_NS;

namespace {

// "29 Sep 2021" -> 20210929, the form in which the running LAMMPS gives its version.
int version_number(const char *text)
{
  int day = 0, year = 0;
  char name[4] = "";
  if (sscanf(text, "%d %3s%*[a-z] %d", &day, name, &year) != 3)
    sscanf(text, "%d %3s %d", &day, name, &year);
  const char *months = "JanFebMarAprMayJunJulAugSepOctNovDec";
  const char *month = strstr(months, name);
  return 10000 * year + 100 * static_cast<int>((month - months) / 3 + 1) + day;
}

// The classes of another version have another layout in memory: LAMMPS itself only prints a warning
// and then crashes, so the run ends here.  Only LAMMPS' C interface is used, which does not change.
void refuse_other_version(void *lmp)
{
  const int running = lammps_version(lmp);
  const int built_for = version_number(LAMMPS_VERSION);
  if (running == built_for) return;
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0) {
    fprintf(stderr,
            "ERROR: biemplugin.so was built for LAMMPS %d (%s), but LAMMPS %d is loading it. "
            "Build it again with -DLAMMPS_HEADER_DIR=<src folder of LAMMPS %d>.\n",
            built_for, LAMMPS_VERSION, running, running);
    fflush(stderr);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

template <class Base, class Style> void set_creator(lammpsplugin_t &plugin)
{
  plugin.creator.v1 = reinterpret_cast<lammpsplugin_factory1 *>(&create_style<Base, Style>);
}

template <class Base, class Style> void set_creator_with_arguments(lammpsplugin_t &plugin)
{
  plugin.creator.v2 =
      reinterpret_cast<lammpsplugin_factory2 *>(&create_style_with_arguments<Base, Style>);
}

}    // namespace

#define set_creator_pair set_creator
#define set_creator_angle set_creator
#define set_creator_dihedral set_creator
#define set_creator_command set_creator
#define set_creator_fix set_creator_with_arguments
#define set_creator_compute set_creator_with_arguments

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *register_function)
{
  refuse_other_version(lmp);
  const auto register_style = reinterpret_cast<lammpsplugin_regfunc>(register_function);
  lammpsplugin_t plugin;
  plugin.version = LAMMPS_VERSION;
  plugin.author = "USER-BIEM";
  plugin.info = "deformable cells in Stokes flow by boundary integrals";
  plugin.handle = handle;
#define BIEM_REGISTER(kind, style_name, Base, Class) \
  plugin.style = #kind;                              \
  plugin.name = style_name;                          \
  set_creator_##kind<Base, Class>(plugin);           \
  register_style(&plugin, lmp);
  BIEM_STYLES(BIEM_REGISTER)
#undef BIEM_REGISTER
}
