// What fix biem shows of an evaluation: its global vector, and a table with a row for each
// particle, wall or cell of another viscosity. Computes nothing that the flow solver does not
// already have.
#ifndef BIEM_LAMMPS_OUTPUT_H
#define BIEM_LAMMPS_OUTPUT_H

#include "biem_lammps_integrator.h"

namespace LAMMPS_NS {

class FlowOutput : protected Pointers {
 public:
  FlowOutput(LAMMPS *lmp, const FixBiemSettings &settings) : Pointers(lmp), settings_(settings) {}

  // Entries of the vector, then columns of the table; see doc/fix_biem.md.
  enum {
    kPower,
    kVolumeError,
    kRmsVelocity,
    kMaxVelocity,
    kStrain,
    kFlips,
    kRealTime,
    kNearTime,
    kFourierTime,
    kExpectedError,
    kIterations,
    kResidual,
    kCoupledTime,
    kMeanVelocity,
    kPressureDrop = kMeanVelocity + 3,
    kWallStress = kPressureDrop + 3,
    kWallShearRate = kWallStress + 3,
    kEvaluations,
    kInnerEvaluations,
    kStages,
    kRadius,
    kTime,
    kStepError,
    kRepeated,    // or split
    kVectorSize
  };
  enum {
    kPosition = 0,
    kBodyVelocity = 3,
    kRotation = 6,
    kQuaternion = 9,    // w x y z
    kForce = 13,
    kStresslet = 16,    // xx yy zz xy xz yz
    kColumns = 22
  };

  double vector(int i) const { return vector_[i]; }
  double table(int row, int column) const;

  // Start of a run: times count from here.
  void start(const LammpsSolver &solver);
  // Collective.
  void publish(const biem::Evaluation &evaluation, LammpsSolver &solver, const ShearedBox &box,
               const LammpsIntegrator &integrator);

 private:
  enum { kReal, kNear, kFourier, kCoupled, kTimes };
  static void get_times(const LammpsSolver &solver, double *times);
  void update_velocities(const biem::Evaluation &evaluation, LammpsSolver &solver);
  void update_table(const biem::Evaluation &evaluation, LammpsSolver &solver);

  FixBiemSettings settings_;
  double vector_[kVectorSize] = {};
  double start_times_[kTimes] = {};
  std::vector<double> table_;
};

}    // namespace LAMMPS_NS

#endif
