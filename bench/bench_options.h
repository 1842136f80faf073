// Lists on the command line of the benchmarks, and their summary over the ranks.
#ifndef BIEM_BENCH_OPTIONS_H
#define BIEM_BENCH_OPTIONS_H

#include "biem_error.h"
#include <mpi.h>
#include <sstream>
#include <string>
#include <vector>

namespace biem_bench {

// "a,b,c" -> {"a", "b", "c"}
inline std::vector<std::string> split_list(const std::string &text)
{
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');)
    words.push_back(word);
  if (words.empty()) throw biem::Error("an option has an empty list");
  return words;
}

inline double parse_number(const std::string &text)
{
  std::istringstream stream(text);
  double value = 0.0;
  if (!(stream >> value) || !stream.eof())
    throw biem::Error("'" + text + "' is not a number; lists are separated by commas only");
  return value;
}

inline int get_rank(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

inline int get_n_ranks(MPI_Comm comm)
{
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  return n_ranks;
}

}    // namespace biem_bench

#endif
