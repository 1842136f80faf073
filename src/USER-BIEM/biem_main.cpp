// Main program lmp_biem: LAMMPS' own main() plus the styles of this package, for a LAMMPS library
// that is already built (the distribution's).  Knows how LAMMPS finds styles; knows no physics.
#include "biem_lammps_styles.h"

#include "command.h"
#include "exceptions.h"
#include "force.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"

#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

using namespace LAMMPS_NS;

namespace {

template <class Style> void add_pair(LAMMPS *lmp, const char *name)
{
  (*lmp->force->pair_map)[name] = &create_style<Pair, Style>;
}

template <class Style> void add_angle(LAMMPS *lmp, const char *name)
{
  (*lmp->force->angle_map)[name] = &create_style<Angle, Style>;
}

template <class Style> void add_dihedral(LAMMPS *lmp, const char *name)
{
  (*lmp->force->dihedral_map)[name] = &create_style<Dihedral, Style>;
}

template <class Style> void add_compute(LAMMPS *lmp, const char *name)
{
  (*lmp->modify->compute_map)[name] = &create_style_with_arguments<Compute, Style>;
}

template <class Style> void add_fix(LAMMPS *lmp, const char *name)
{
  (*lmp->modify->fix_map)[name] = &create_style_with_arguments<Fix, Style>;
}

template <class Style> void add_command(LAMMPS *lmp, const char *name)
{
  (*lmp->input->command_map)[name] = &create_style<Command, Style>;
}

void add_styles(LAMMPS *lmp)
{
#define BIEM_ADD(kind, name, Base, Class) add_##kind<Class>(lmp, name);
  BIEM_STYLES(BIEM_ADD)
#undef BIEM_ADD
}

// `clear` makes new, empty lists of pair, angle, dihedral, compute and fix styles, but keeps the
// list of commands.  No style of ours can be used before there is a box, and a box comes from one
// of these three commands only: each adds our styles again before it does its own work.
constexpr int n_box_commands = 3;
const char *const box_commands[n_box_commands] = {"create_box", "read_data", "read_restart"};
Input::CommandCreator original_creators[n_box_commands];

template <int index> Command *create_box_command(LAMMPS *lmp)
{
  add_styles(lmp);
  return original_creators[index](lmp);
}

template <int index> void hook_box_command(LAMMPS *lmp)
{
  Input::CommandCreator &creator = (*lmp->input->command_map)[box_commands[index]];
  original_creators[index] = creator;
  creator = &create_box_command<index>;
}

void hook_box_commands(LAMMPS *lmp)
{
  hook_box_command<0>(lmp);
  hook_box_command<1>(lmp);
  hook_box_command<2>(lmp);
}

// LAMMPS prints its own lists for -h and ends; ours goes before them.
void print_styles_if_asked(int argc, char **argv)
{
  int rank;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  for (int i = 1; i < argc && rank == 0; i++) {
    if (strcmp(argv[i], "-h") != 0 && strcmp(argv[i], "-help") != 0) continue;
    puts("Styles and commands of USER-BIEM:");
#define BIEM_PRINT(kind, name, Base, Class) printf("  %-10s %s\n", #kind, name);
    BIEM_STYLES(BIEM_PRINT)
#undef BIEM_PRINT
    fflush(stdout);
    return;
  }
}

}    // namespace

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  print_styles_if_asked(argc, argv);
  try {
    LAMMPS *lmp = new LAMMPS(argc, argv, MPI_COMM_WORLD);
    add_styles(lmp);
    hook_box_commands(lmp);
    lmp->input->file();
    delete lmp;
  } catch (LAMMPSAbortException &) {
    // One rank failed alone (error->one): the others would wait for it for ever.
    MPI_Abort(MPI_COMM_WORLD, 1);
  } catch (LAMMPSException &) {
    // All ranks failed together (error->all), and LAMMPS has printed the message.
    MPI_Barrier(MPI_COMM_WORLD);
    MPI_Finalize();
    return EXIT_FAILURE;
  } catch (std::exception &error) {
    fprintf(stderr, "ERROR: %s (unexpected; thrown through LAMMPS)\n", error.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Finalize();
  return EXIT_SUCCESS;
}
