// Columns of fix biem's array, three for each vector. Published ones come first, then what a
// restart file keeps, then what lives within one step only. All migrate with their atoms.
#ifndef BIEM_LAMMPS_COLUMNS_H
#define BIEM_LAMMPS_COLUMNS_H

namespace LAMMPS_NS {
namespace NodeColumn {

enum {
  kVelocity = 0,    // relative to the background flow
  kTraction = 3,
  kArea = 6,
  kPublished = 7,    // how many the input script sees
  // One step ago (Adams-Bashforth): velocity and length of the step.
  kPrevious = 7,
  kPreviousDt = 10,
  // Solution of the coupled system, last and last but one; of rigid particles in the body frame.
  kSolution = 11,
  kPreviousSolution = 14,
  kStiffMode = 17,    // displacement that relaxes fastest
  // Part of the velocity that changes slowly, last and last but one (multirate).
  kSlow = 20,
  kPreviousSlow = 23,
  kStepError = 26,    // estimate of the last step, displacement
  kKept = 29,         // how many a restart file has
  // Within a step: rate of displacement at its start, displacement at the last two stages, all
  // relative to where the background shear alone would carry the node; unwrapped position and
  // velocity at the start.
  kStartRate = 29,
  kDisplacement = 32,
  kPreviousDisplacement = 35,
  kStartPosition = 38,
  kStartVelocity = 41,
  // While the stiffness is estimated: Krylov vectors.
  kKrylov = 44,
  kColumns = 56
};

}    // namespace NodeColumn
}    // namespace LAMMPS_NS

#endif
