// pair_style biem/contact: backup repulsion of surfaces that touch. Parses, calls the law,
// publishes.
#ifdef PAIR_CLASS
// clang-format off
PairStyle(biem/contact,PairBiemContact);
// clang-format on
#else

#ifndef LMP_PAIR_BIEM_CONTACT_H
#define LMP_PAIR_BIEM_CONTACT_H

#include "pair.h"
#include <string>

namespace LAMMPS_NS {

// How often and how strongly the repulsion has acted; the same on all ranks.
struct ContactStatistics {
  bigint n_evaluations;        // of the forces
  bigint n_with_contact;       // of these, with any node within range of another surface
  bigint n_node_contacts;      // summed over the evaluations
  bigint n_penetrations;       // of these, with the node behind the other surface
  double smallest_distance;    // signed; the range where there was no contact, length
  double largest_pressure;     // force/area
  void reset(double range);
};

class PairBiemContact : public Pair {
 public:
  PairBiemContact(class LAMMPS *);
  ~PairBiemContact() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  void init_list(int, class NeighList *) override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  void write_data(FILE *) override;
  void write_data_all(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;

  // Since the start of the last run. fix biem finds the style with force->pair_match().
  const ContactStatistics &statistics() const { return statistics_of_run; }
  std::string describe_statistics() const;    // one sentence, for the end of a run

 protected:
  struct Impl;
  Impl *impl;
  double range;           // delta, length
  double **stiffness;     // k by atom types of node and triangle, symmetric, force/area
  char *wall_group;       // nullptr: none
  ContactStatistics statistics_of_run;

  void allocate();
  void begin_run();
  void set_range(double value, const char *group_name);
  void tally(const struct NodeContact &contact, const double *force, double energy);
  void publish(const double sums[2], const double extremes[2]);
};

}    // namespace LAMMPS_NS

#endif
#endif
