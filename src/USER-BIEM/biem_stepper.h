// Names of the time steppers, and those of one evaluation: displacement of one node relative to
// the background flow.
// Pure functions of the velocity history; knows no nodes, no LAMMPS.
#ifndef BIEM_STEPPER_H
#define BIEM_STEPPER_H

#include "biem_types.h"
#include <string>

namespace biem {

enum class Stepper { Euler, AdamsBashforth2, RungeKuttaChebyshev2 };

// "rkc2", "ab2" or "euler"; throws Error with the choices otherwise.
Stepper parse_stepper(const std::string &name);

// velocity now and one step ago [length/time]; previous_dt <= 0 means no history yet, then both
// steppers take an Euler step. Variable steps: dt need not equal previous_dt.
Vec3 compute_displacement(Stepper stepper, const Vec3 &velocity, const Vec3 &previous_velocity,
                          double dt, double previous_dt);

// Largest dt times spectral radius at which a stepper of one evaluation damps all modes.
double stability_limit(Stepper stepper);

}    // namespace biem

#endif
