// Setup report: see the header.
#include "biem_lammps_report.h"
#include "atom.h"
#include "fmt/format.h"
#include "lammps.h"
#include "update.h"
#include <map>

namespace LAMMPS_NS {

namespace {

// Error of the velocity of a smooth traction on flat triangles: 0.55 % at 642 nodes a cell, second
// order (doc/theory, label accuracy).
constexpr double kSmoothErrorPercent = 0.55, kSmoothErrorNodes = 642.0;

// In which units moduli and viscosity are.
std::string describe_units(const std::string &style)
{
  static const std::map<std::string, std::string> text = {
      {"lj", "dimensionless: lengths, times and viscosity as chosen by the input script, ES and ED "
             "in viscosity * length / time, EB in viscosity * length^3 / time"},
      {"si", "viscosity in Pa s, ES and ED in N/m, EB in J"},
      {"cgs", "viscosity in poise, ES and ED in dyn/cm, EB in erg"},
      {"micro", "viscosity in pg/(um us) = mPa s, ES and ED in pg/us^2 = mN/m, EB in pg um^2/us^2 "
                "= 1e-15 J"},
      {"nano", "viscosity in ag/(nm ns) = mPa s, ES and ED in ag/ns^2 = mN/m, EB in ag nm^2/ns^2 = "
               "1e-21 J"},
      {"real", "viscosity in poise, ES and ED in kcal/(mol Angstrom^2), EB in kcal/mol"},
      {"metal", "viscosity in poise, ES and ED in eV/Angstrom^2, EB in eV"}};
  return "units " + style + ": " + (text.count(style) ? text.at(style) : "as documented by LAMMPS");
}

// Empty if the periodic sum keeps its tolerance, as it does unless parameters were given.
std::string warn_of_error(const biem::EwaldParameters &p)
{
  if (p.expected_error <= p.tolerance) return "";
  return fmt::format("WARNING: Fix biem: expected error {:.2g} of the periodic sum is larger than "
                     "accuracy {:.2g}: the parameters that are given (keywords cutoff, splitting, "
                     "order, grid) do not reach it; leave some of them out, or give a larger "
                     "cutoff, a higher order or a finer grid\n",
                     p.expected_error, p.tolerance);
}

std::string describe_sum(const std::string &of, const biem::EwaldParameters &p)
{
  std::string text =
      fmt::format("  periodic sum of {} ({}): requested error {:.2g}, expected {:.2g}\n", of,
                  biem::describe(p.method), p.tolerance, p.expected_error);
  text += fmt::format("    cutoff {:.4g}, band limit {:.4g}, grid {} x {} x {}, window order {}\n",
                      p.cutoff, p.band_limit, p.grid[0], p.grid[1], p.grid[2], p.order);
  return text + warn_of_error(p);
}

}    // namespace

std::string describe_setup(LAMMPS *lmp, const MeshSurvey &s, const biem::EwaldParameters &forces,
                           const biem::EwaldParameters *coupled, const double cutoffs[2])
{
  std::string text =
      fmt::format("Fix biem: {} surfaces, {} nodes, {} triangles, {} points in the flow\n",
                  s.n_surfaces, s.n_nodes, s.n_triangles, lmp->atom->natoms - s.n_nodes);
  text += biem::describe_blocks(s.blocks);
  text += "  " + describe_units(lmp->update->unit_style) + "\n";
  if (s.blocks.n_free + s.blocks.n_contrast > 0 || !coupled)
    text += describe_sum("the membrane forces", forces);
  if (coupled) text += describe_sum("the coupled system", *coupled);
  if (s.n_surfaces > 0) {
    const double nodes = static_cast<double>(s.n_nodes) / s.n_surfaces;
    text += fmt::format(
        "  surfaces: {:.0f} nodes a surface, longest edge {:.4g}; expected error with a "
        "smooth traction {:.2g} %\n",
        nodes, s.longest_edge, kSmoothErrorPercent * kSmoothErrorNodes / nodes);
  }
  text += fmt::format("  communication cutoff {:.4g}, near list cutoff {:.4g}\n", cutoffs[0],
                      cutoffs[1]);
  return text;
}

}    // namespace LAMMPS_NS
