// Messages of the errors that code under test throws.
#ifndef BIEM_TESTS_ERROR_MESSAGES_H
#define BIEM_TESTS_ERROR_MESSAGES_H

#include "biem_error.h"
#include <functional>
#include <string>

namespace biem {

// Empty if nothing is thrown.
inline std::string message_of(const std::function<void()> &function)
{
  try {
    function();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

}    // namespace biem

#endif
