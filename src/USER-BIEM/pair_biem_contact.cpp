// pair_style biem/contact: hands contacts to the law and takes back forces and energies.
// Knows no formula of the law and not how contacts are found.
#include "pair_biem_contact.h"

#include "biem_contact_law.h"
#include "biem_error.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_contacts.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "neighbor.h"

#include <algorithm>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;

// Extra quantities, for compute pair.
enum { N_CONTACTS, SMALLEST_DISTANCE, LARGEST_PRESSURE, N_PENETRATED, N_EXTRA };

struct PairBiemContact::Impl {
  LammpsContacts contacts;
  bigint list_number = -1;    // of the neighbor list that the contacts were sorted for
  bool is_new_run = true;

  Impl(LAMMPS *lmp, Pair *pair, double range) : contacts(lmp, pair, range) {}
};

void ContactStatistics::reset(double range)
{
  n_evaluations = n_with_contact = n_node_contacts = n_penetrations = 0;
  smallest_distance = range;
  largest_pressure = 0.0;
}

/* ---------------------------------------------------------------------- */

PairBiemContact::PairBiemContact(LAMMPS *lmp) :
    Pair(lmp), impl(nullptr), range(0.0), stiffness(nullptr), wall_group(nullptr)
{
  restartinfo = 1;
  writedata = 1;
  single_enable = 0;
  respa_enable = 0;
  no_virial_fdotr_compute = 1;
  comm_forward = comm_reverse = LammpsContacts::kMessageSize;
  nextra = N_EXTRA;
  pvector = new double[N_EXTRA]();
  statistics_of_run.reset(0.0);
}

PairBiemContact::~PairBiemContact()
{
  if (copymode) return;
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
    memory->destroy(stiffness);
  }
  delete impl;
  delete[] wall_group;
  delete[] pvector;
}

void PairBiemContact::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  memory->create(stiffness, n, n, "pair:stiffness");
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      setflag[i][j] = 0;
      stiffness[i][j] = 0.0;
    }
}

void PairBiemContact::settings(int narg, char **arg)
{
  if (narg != 1 && !(narg == 3 && strcmp(arg[1], "walls") == 0))
    error->all(FLERR, "Pair style biem/contact takes a range delta and optionally 'walls <group>', "
               "but has {} values", narg);
  set_range(utils::numeric(FLERR, arg[0], false, lmp), narg == 3 ? arg[2] : "");
}

void PairBiemContact::set_range(double value, const char *group_name)
{
  try {
    biem::ContactLaw(0.0, value);
  } catch (biem::Error &e) {
    error->all(FLERR, "Pair style biem/contact: {}", e.what());
  }
  range = value;
  delete[] wall_group;
  wall_group = *group_name ? utils::strdup(group_name) : nullptr;
  statistics_of_run.reset(range);
  delete impl;
  impl = new Impl(lmp, this, range);
}

void PairBiemContact::coeff(int narg, char **arg)
{
  if (narg != 3)
    error->all(FLERR, "pair_coeff for biem/contact takes two atom types and k, but has {} values",
               narg);
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);
  const double k = utils::numeric(FLERR, arg[2], false, lmp);
  try {
    biem::ContactLaw(k, range);
  } catch (biem::Error &e) {
    error->all(FLERR, "pair_coeff {} {} for biem/contact: {}", arg[0], arg[1], e.what());
  }
  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++, count++) {
      stiffness[i][j] = stiffness[j][i] = k;
      setflag[i][j] = 1;
    }
  if (count == 0)
    error->all(FLERR, "pair_coeff {} {} for biem/contact sets nothing: give the smaller atom type "
               "first", arg[0], arg[1]);
}

void PairBiemContact::init_style()
{
  if (!force->newton_pair || !force->newton_bond)
    error->all(FLERR, "Pair style biem/contact needs each triangle on exactly one process: "
               "set 'newton on' before the simulation box is defined");
  if (!atom->molecule_flag || atom->molecular != Atom::MOLECULAR || !atom->tag_enable)
    error->all(FLERR, "Pair style biem/contact tells surfaces apart by molecule IDs and needs "
               "their triangles (angles): use atom_style molecular or full");
  if (atom->nangles > 0 && !force->angle)
    error->all(FLERR, "Pair style biem/contact: the triangles (angles) need an angle style: "
               "biem/skalak for membranes, zero for rigid particles and walls");
  int wall_bit = 0;
  if (wall_group) {
    const int index = group->find(wall_group);
    if (index < 0)
      error->all(FLERR, "Pair style biem/contact: group {} of the walls does not exist",
                 wall_group);
    wall_bit = group->bitmask[index];
  }
  impl->contacts.surfaces.survey(wall_bit);
  impl->is_new_run = true;
  BiemCompat::request_full_list(neighbor, this, instance_me);
}

void PairBiemContact::init_list(int, NeighList *ptr)
{
  list = ptr;
  impl->list_number = -1;
}

// A node is a neighbor of the middle atom of each triangle that it can touch.
double PairBiemContact::init_one(int i, int j)
{
  if (setflag[i][j] == 0)
    error->all(FLERR, "Pair style biem/contact: no pair_coeff for atom types {} {}; there is no "
               "mixing, and k = 0 means that they do not touch", i, j);
  stiffness[j][i] = stiffness[i][j];
  const ContactSurfaces &surfaces = impl->contacts.surfaces;
  return range + std::max(surfaces.edge_limit(i), surfaces.edge_limit(j));
}

// With the first forces of a run: Pair::setup() is not called by rerun.
void PairBiemContact::begin_run()
{
  impl->contacts.surfaces.measure_areas();
  statistics_of_run.reset(range);
  impl->is_new_run = false;
}

/* ---------------------------------------------------------------------- */

void PairBiemContact::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  LammpsContacts &contacts = impl->contacts;
  if (impl->is_new_run) begin_run();
  if (neighbor->ago == 0 || impl->list_number != neighbor->ncalls) {
    contacts.sort_neighbors(list, stiffness);
    impl->list_number = neighbor->ncalls;
  }
  double sums[2] = {0.0, 0.0}, extremes[2] = {-range, 0.0};
  double **f = atom->f;
  for (const NodeContact &contact : contacts.find_contacts()) {
    const int *t = contact.triangle;
    const double k = stiffness[atom->type[contact.node]][atom->type[t[1]]];
    const biem::ContactResponse response =
        biem::ContactLaw(k, range).compute_response(contact.distance);
    // Between two bodies the nodes of both act, and each counts half.
    const double share = contacts.surfaces.is_body(atom->molecule[t[1]]) ? 0.5 : 1.0;
    const double area = share * contacts.surfaces.area(atom->tag[contact.node]);
    const biem::Vec3 push = area * response.pressure * contact.direction;
    for (int c = 0; c < 3; c++) {
      f[contact.node][c] += push[c];
      for (int corner = 0; corner < 3; corner++)
        f[t[corner]][c] -= contact.weights[corner] * push[c];
    }
    if (evflag) tally(contact, push.data(), area * response.energy);
    sums[0] += 1.0;
    sums[1] += contact.distance < 0.0;
    extremes[0] = std::max(extremes[0], -contact.distance);
    extremes[1] = std::max(extremes[1], response.pressure);
  }
  publish(sums, extremes);
}

// Half of energy and virial to the node, half to the corners of the triangle by their weights.
void PairBiemContact::tally(const NodeContact &contact, const double *push, double energy)
{
  const biem::Vec3 arm = contact.distance * contact.direction;
  const double virial_parts[6] = {arm[0] * push[0], arm[1] * push[1], arm[2] * push[2],
                                  arm[0] * push[1], arm[0] * push[2], arm[1] * push[2]};
  if (eflag_global) eng_vdwl += energy;
  for (int v = 0; vflag_global && v < 6; v++) virial[v] += virial_parts[v];
  for (int n = 0; n < 4; n++) {
    const int i = n < 3 ? contact.triangle[n] : contact.node;
    const double weight = n < 3 ? 0.5 * contact.weights[n] : 0.5;
    if (eflag_atom) eatom[i] += weight * energy;
    for (int v = 0; vflag_atom && v < 6; v++) vatom[i][v] += weight * virial_parts[v];
  }
}

// Sums: contacts, penetrated nodes; extremes: minus the smallest distance, largest pressure.
void PairBiemContact::publish(const double sums[2], const double extremes[2])
{
  double all_sums[2] = {0.0, 0.0}, all_extremes[2] = {-range, 0.0};
  if (impl->contacts.has_any()) {
    MPI_Allreduce(sums, all_sums, 2, MPI_DOUBLE, MPI_SUM, world);
    MPI_Allreduce(extremes, all_extremes, 2, MPI_DOUBLE, MPI_MAX, world);
  }
  ContactStatistics &s = statistics_of_run;
  s.n_evaluations++;
  s.n_with_contact += all_sums[0] > 0.0;
  s.n_node_contacts += static_cast<bigint>(all_sums[0]);
  s.n_penetrations += static_cast<bigint>(all_sums[1]);
  s.smallest_distance = std::min(s.smallest_distance, -all_extremes[0]);
  s.largest_pressure = std::max(s.largest_pressure, all_extremes[1]);

  // compute pair adds up the ranks
  const double share = comm->me == 0 ? 1.0 : 0.0;
  pvector[N_CONTACTS] = share * all_sums[0];
  pvector[SMALLEST_DISTANCE] = share * -all_extremes[0];
  pvector[LARGEST_PRESSURE] = share * all_extremes[1];
  pvector[N_PENETRATED] = share * all_sums[1];
}

/* ---------------------------------------------------------------------- */

int PairBiemContact::pack_forward_comm(int n, int *atoms, double *buffer, int, int *)
{
  return impl->contacts.pack_forward(n, atoms, buffer);
}

void PairBiemContact::unpack_forward_comm(int n, int first, double *buffer)
{
  impl->contacts.unpack_forward(n, first, buffer);
}

int PairBiemContact::pack_reverse_comm(int n, int first, double *buffer)
{
  return impl->contacts.pack_reverse(n, first, buffer);
}

void PairBiemContact::unpack_reverse_comm(int n, int *atoms, double *buffer)
{
  impl->contacts.unpack_reverse(n, atoms, buffer);
}

/* ---------------------------------------------------------------------- */

void PairBiemContact::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      fwrite(&setflag[i][j], sizeof(int), 1, fp);
      fwrite(&stiffness[i][j], sizeof(double), 1, fp);
    }
}

void PairBiemContact::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      if (comm->me == 0) {
        utils::sfread(FLERR, &setflag[i][j], sizeof(int), 1, fp, nullptr, error);
        utils::sfread(FLERR, &stiffness[i][j], sizeof(double), 1, fp, nullptr, error);
      }
      MPI_Bcast(&setflag[i][j], 1, MPI_INT, 0, world);
      MPI_Bcast(&stiffness[i][j], 1, MPI_DOUBLE, 0, world);
      stiffness[j][i] = stiffness[i][j];
    }
}

void PairBiemContact::write_restart_settings(FILE *fp)
{
  const int length = wall_group ? static_cast<int>(strlen(wall_group)) : 0;
  fwrite(&range, sizeof(double), 1, fp);
  fwrite(&length, sizeof(int), 1, fp);
  if (wall_group) fwrite(wall_group, sizeof(char), length, fp);
}

void PairBiemContact::read_restart_settings(FILE *fp)
{
  double value = 0.0;
  int length = 0;
  if (comm->me == 0) {
    utils::sfread(FLERR, &value, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &length, sizeof(int), 1, fp, nullptr, error);
  }
  MPI_Bcast(&value, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&length, 1, MPI_INT, 0, world);
  std::string name(length, ' ');
  if (length > 0) {
    if (comm->me == 0) utils::sfread(FLERR, &name[0], sizeof(char), length, fp, nullptr, error);
    MPI_Bcast(&name[0], length, MPI_CHAR, 0, world);
  }
  set_range(value, name.c_str());
}

void PairBiemContact::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++) fprintf(fp, "%d %.17g\n", i, stiffness[i][i]);
}

void PairBiemContact::write_data_all(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) fprintf(fp, "%d %d %.17g\n", i, j, stiffness[i][j]);
}

/* ---------------------------------------------------------------------- */

std::string PairBiemContact::describe_statistics() const
{
  const ContactStatistics &s = statistics_of_run;
  if (s.n_with_contact == 0)
    return fmt::format("pair biem/contact has not acted in {} evaluations: no node came within its "
                       "range of another surface",
                       s.n_evaluations);
  return fmt::format("pair biem/contact has acted in {} of {} evaluations, on {:.3g} nodes at a "
                     "time; smallest distance {:.4g}, largest pressure {:.4g}, {} nodes behind the "
                     "other surface",
                     s.n_with_contact, s.n_evaluations,
                     static_cast<double>(s.n_node_contacts) / static_cast<double>(s.n_with_contact),
                     s.smallest_distance, s.largest_pressure, s.n_penetrations);
}
