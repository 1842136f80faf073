// CPU time of this thread (POSIX), for the breakdowns that the package reports.
#ifndef BIEM_CPU_CLOCK_H
#define BIEM_CPU_CLOCK_H

#include <ctime>

namespace biem {

class CpuClock {
 public:
  CpuClock() : start_(now()) {}

  // Seconds since construction or the last restart.
  double restart()
  {
    const double end = now(), elapsed = end - start_;
    start_ = end;
    return elapsed;
  }

 private:
  static double now()
  {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }

  double start_;
};

}    // namespace biem

#endif
