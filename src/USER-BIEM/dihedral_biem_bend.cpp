// dihedral_style biem/bend: hands hinges to the bending law and takes back forces and energies.
// Knows no formula of the law.
#include "dihedral_biem_bend.h"

#include "biem_error.h"
#include "biem_membrane_bend.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr double DEGREE = M_PI / 180.0;

static biem::HingeNodes load_hinge(double **x, int i1, int i2, int i3, int i4)
{
  return {biem::Vec3(x[i1]), biem::Vec3(x[i2]), biem::Vec3(x[i3]), biem::Vec3(x[i4])};
}

/* ---------------------------------------------------------------------- */

DihedralBiemBend::DihedralBiemBend(LAMMPS *lmp) :
    Dihedral(lmp), bending_modulus(nullptr), angle(nullptr), angle_of_sphere(nullptr)
{
  writedata = 1;
}

DihedralBiemBend::~DihedralBiemBend()
{
  if (allocated && !copymode) {
    memory->destroy(setflag);
    memory->destroy(bending_modulus);
    memory->destroy(angle);
    memory->destroy(angle_of_sphere);
  }
}

void DihedralBiemBend::allocate()
{
  allocated = 1;
  const int n = atom->ndihedraltypes + 1;
  memory->create(bending_modulus, n, "dihedral:bending_modulus");
  memory->create(angle, n, "dihedral:angle");
  memory->create(angle_of_sphere, n, "dihedral:angle_of_sphere");
  memory->create(setflag, n, "dihedral:setflag");
  for (int i = 0; i < n; i++) setflag[i] = 0;
}

void DihedralBiemBend::coeff(int narg, char **arg)
{
  if (narg != 3)
    error->all(FLERR, "dihedral_coeff for biem/bend takes a type, EB and 'sphere' or beta0, but "
               "has {} values", narg);
  if (!allocated) allocate();
  int ilo, ihi;
  utils::bounds(FLERR, arg[0], 1, atom->ndihedraltypes, ilo, ihi, error);
  const double modulus = utils::numeric(FLERR, arg[1], false, lmp);
  const int sphere = strcmp(arg[2], "sphere") == 0;
  const double beta0 = sphere ? 0.0 : utils::numeric(FLERR, arg[2], false, lmp) * DEGREE;
  try {
    biem::HingeLaw(modulus, beta0);
  } catch (biem::Error &e) {
    error->all(FLERR, "dihedral_coeff {} for biem/bend: {}", arg[0], e.what());
  }
  for (int i = ilo; i <= ihi; i++) {
    bending_modulus[i] = modulus;
    angle[i] = beta0;
    angle_of_sphere[i] = sphere;
    setflag[i] = 1;
  }
}

void DihedralBiemBend::init_style()
{
  if (!force->newton_bond)
    error->all(FLERR, "Dihedral style biem/bend needs each hinge on exactly one process: "
               "set 'newton on' before the simulation box is defined");
  sphere_angle.clear();
  for (int i = 1; i <= atom->ndihedraltypes; i++)
    if (setflag[i] && angle_of_sphere[i]) {
      compute_sphere_angles();
      break;
    }
}

/* ----------------------------------------------------------------------
   with newton on, LAMMPS stores a triangle with its second atom only, so the number of stored
   angles of a molecule is its number of triangles, however the atoms are spread over processes
------------------------------------------------------------------------- */

void DihedralBiemBend::compute_sphere_angles()
{
  if (!atom->molecule_flag || atom->molecular != Atom::MOLECULAR)
    error->all(FLERR, "Dihedral style biem/bend with 'sphere' counts triangles per molecule: it "
               "needs molecule IDs and an atom style that stores bonds and angles per atom "
               "(molecular or full)");
  const tagint *molecule = atom->molecule;
  tagint last = 0, last_all;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, molecule[i]);
  MPI_Allreduce(&last, &last_all, 1, MPI_LMP_TAGINT, MPI_MAX, world);

  std::vector<int> n_triangles(last_all + 1, 0), n_triangles_all(last_all + 1);
  for (int i = 0; i < atom->nlocal; i++)
    n_triangles[std::max<tagint>(molecule[i], 0)] += atom->num_angle[i];
  MPI_Allreduce(n_triangles.data(), n_triangles_all.data(), static_cast<int>(last_all + 1),
                MPI_INT, MPI_SUM, world);

  sphere_angle.assign(last_all + 1, 0.0);
  try {
    for (tagint m = 1; m <= last_all; m++)
      if (n_triangles_all[m] > 0) sphere_angle[m] = biem::compute_sphere_angle(n_triangles_all[m]);
  } catch (biem::Error &e) {
    error->all(FLERR, "Dihedral style biem/bend: {}", e.what());
  }
}

double DihedralBiemBend::find_angle(int type, int i2)
{
  if (!angle_of_sphere[type]) return angle[type];
  const tagint m = atom->molecule[i2];
  if (m < 1 || m >= static_cast<tagint>(sphere_angle.size()) || sphere_angle[m] == 0.0)
    error->one(FLERR, "Dihedral style biem/bend with 'sphere': atom {} has molecule ID {}, a "
               "molecule without triangles (angles); give beta0 as a value or set molecule IDs",
               atom->tag[i2], m);
  return sphere_angle[m];
}

/* ---------------------------------------------------------------------- */

void DihedralBiemBend::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  double **x = atom->x, **f = atom->f;
  const int nlocal = atom->nlocal;

  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *t = neighbor->dihedrallist[n];
    const biem::HingeNodes nodes = load_hinge(x, t[0], t[1], t[2], t[3]);
    biem::HingeResponse response =
        biem::HingeLaw(bending_modulus[t[4]], find_angle(t[4], t[1])).compute_response(nodes);
    if (!std::isfinite(response.energy))
      error->one(FLERR, "Dihedral style biem/bend: a triangle of the hinge of atoms {} {} {} {} "
                 "has collapsed or has positions that are not numbers on step {}; is the time "
                 "step too large?", atom->tag[t[0]], atom->tag[t[1]], atom->tag[t[2]],
                 atom->tag[t[3]], update->ntimestep);

    for (int k = 0; k < 4; k++)
      for (int c = 0; c < 3; c++) f[t[k]][c] += response.force[k][c];
    if (evflag) {
      const biem::Vec3 d1 = nodes[0] - nodes[1], d2 = nodes[2] - nodes[1], d3 = nodes[3] - nodes[2];
      ev_tally(t[0], t[1], t[2], t[3], nlocal, force->newton_bond, response.energy,
               response.force[0].data(), response.force[2].data(), response.force[3].data(), d1[0],
               d1[1], d1[2], d2[0], d2[1], d2[2], d3[0], d3[1], d3[2]);
    }
  }
}

double DihedralBiemBend::compute_hinge_energy(int type, int i1, int i2, int i3, int i4)
{
  return biem::HingeLaw(bending_modulus[type], find_angle(type, i2))
      .compute_response(load_hinge(atom->x, i1, i2, i3, i4)).energy;
}

/* ---------------------------------------------------------------------- */

void DihedralBiemBend::write_restart(FILE *fp)
{
  fwrite(&bending_modulus[1], sizeof(double), atom->ndihedraltypes, fp);
  fwrite(&angle[1], sizeof(double), atom->ndihedraltypes, fp);
  fwrite(&angle_of_sphere[1], sizeof(int), atom->ndihedraltypes, fp);
}

void DihedralBiemBend::read_restart(FILE *fp)
{
  allocate();
  const int n = atom->ndihedraltypes;
  if (comm->me == 0) {
    utils::sfread(FLERR, &bending_modulus[1], sizeof(double), n, fp, nullptr, error);
    utils::sfread(FLERR, &angle[1], sizeof(double), n, fp, nullptr, error);
    utils::sfread(FLERR, &angle_of_sphere[1], sizeof(int), n, fp, nullptr, error);
  }
  MPI_Bcast(&bending_modulus[1], n, MPI_DOUBLE, 0, world);
  MPI_Bcast(&angle[1], n, MPI_DOUBLE, 0, world);
  MPI_Bcast(&angle_of_sphere[1], n, MPI_INT, 0, world);
  for (int i = 1; i <= n; i++) setflag[i] = 1;
}

void DihedralBiemBend::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++)
    if (angle_of_sphere[i])
      fprintf(fp, "%d %.17g sphere\n", i, bending_modulus[i]);
    else
      fprintf(fp, "%d %.17g %.17g\n", i, bending_modulus[i], angle[i] / DEGREE);
}
