// The one exception of the core. The message says who, which value, the likely cause and what to
// do. The core never prints and never exits; the LAMMPS bridge turns an Error into
// error->all()/one().
#ifndef BIEM_ERROR_H
#define BIEM_ERROR_H

#include <stdexcept>
#include <string>

namespace biem {

class Error : public std::runtime_error {
 public:
  explicit Error(const std::string &message) : std::runtime_error(message) {}
};

}    // namespace biem

#endif
