// Reading of a command's arguments: see the header.
#include "biem_lammps_command_arguments.h"
#include "biem_error.h"
#include "error.h"
#include "utils.h"
#include <cmath>

namespace LAMMPS_NS {

void CommandArguments::fail(const std::string &what)
{
  error->all(FLERR, command_ + ": " + what);
  throw biem::Error("unreachable: LAMMPS' error handler returned");
}

std::string CommandArguments::keyword()
{
  const std::string keyword = arg_[next_++];
  if (!seen_.insert(keyword).second) fail("keyword '" + keyword + "' is given twice");
  return keyword;
}

std::string CommandArguments::word(const std::string &keyword)
{
  if (is_done()) fail("keyword '" + keyword + "' ends too early: a value is missing");
  return arg_[next_++];
}

double CommandArguments::number(const std::string &keyword)
{
  word(keyword);
  return utils::numeric(FLERR, arg_[next_ - 1], false, lmp);
}

double CommandArguments::positive(const std::string &keyword)
{
  const double value = number(keyword);
  if (!(value > 0.0) || !std::isfinite(value))
    fail(keyword + " " + last_word() + " must be a positive number");
  return value;
}

int CommandArguments::integer(const std::string &keyword)
{
  word(keyword);
  return utils::inumeric(FLERR, arg_[next_ - 1], false, lmp);
}

int CommandArguments::positive_integer(const std::string &keyword)
{
  const int value = integer(keyword);
  if (value < 1) fail(keyword + " " + std::to_string(value) + " must be 1 or more");
  return value;
}

bool CommandArguments::parse_label(const std::string &keyword, SurfaceLabels &labels)
{
  if (keyword == "type") {
    labels.type = positive_integer(keyword);
  } else if (keyword == "angle_type") {
    labels.angle_type = positive_integer(keyword);
  } else if (keyword == "molecule") {
    labels.first_molecule = positive_integer(keyword);
  } else if (keyword == "group") {
    labels.group = word(keyword);
  } else {
    return false;
  }
  return true;
}

}    // namespace LAMMPS_NS
