// Words and numbers of a command of the input script, one after the other, and the labels that
// create_cells and create_wall have in common. Refuses what it cannot read; creates nothing.
#ifndef BIEM_LAMMPS_COMMAND_ARGUMENTS_H
#define BIEM_LAMMPS_COMMAND_ARGUMENTS_H

#include "lmptype.h"
#include "pointers.h"
#include <set>
#include <string>

namespace LAMMPS_NS {

// What the atoms and angles of new surfaces get.
struct SurfaceLabels {
  int type = 1, angle_type = 1;
  tagint first_molecule = 0;    // 0: the next free one
  std::string group;            // empty: none besides all
};

class CommandArguments : protected Pointers {
 public:
  // command: the name with which messages begin
  CommandArguments(LAMMPS *lmp, const std::string &command, int narg, char **arg) :
      Pointers(lmp), command_(command), narg_(narg), arg_(arg)
  {
  }

 protected:
  bool is_done() const { return next_ >= narg_; }
  bool has(const std::string &keyword) const { return seen_.count(keyword) > 0; }
  [[noreturn]] void fail(const std::string &what);

  std::string keyword();    // the next word; an error if it was there before
  std::string word(const std::string &keyword);
  double number(const std::string &keyword);
  double positive(const std::string &keyword);
  int integer(const std::string &keyword);
  int positive_integer(const std::string &keyword);
  void step_back() { next_--; }
  std::string last_word() const { return arg_[next_ - 1]; }

  // True if the keyword was one of type, angle_type, molecule, group.
  bool parse_label(const std::string &keyword, SurfaceLabels &labels);

 private:
  std::string command_;
  int narg_;
  char **arg_;
  int next_ = 0;
  std::set<std::string> seen_;
};

}    // namespace LAMMPS_NS

#endif
