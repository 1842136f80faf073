// Whole surfaces on every rank that owns a part of them: for what needs all nodes of one surface at
// once. Ranks exchange the nodes of the surfaces they share, nothing else. Knows numbers of
// surfaces and nodes, no triangles and no meaning of the values.
#ifndef BIEM_SURFACE_REPLICAS_H
#define BIEM_SURFACE_REPLICAS_H

#include "biem_types.h"
#include <map>
#include <mpi.h>

namespace biem {

class SurfaceReplicas {
 public:
  explicit SurfaceReplicas(MPI_Comm comm) : comm_(comm) {}

  // Of the owned nodes: surface, -1 for those that take no part, and number within the surface.
  // Call again when nodes have migrated. Collective.
  void set_nodes(const std::vector<int> &surface_of_node, const std::vector<int> &index_of_node);
  // values: 3 x n_owned. Returns, for each surface of which this rank owns a node, the values of
  // all its nodes, 3 x n. Collective.
  std::map<int, Points> gather(PointsView values) const;

 private:
  struct Place {
    int surface, index;
  };

  std::vector<std::vector<int>> find_sharing_ranks() const;

  MPI_Comm comm_;
  std::vector<int> nodes_;       // owned nodes that take part
  std::vector<Place> places_;    // theirs
  std::map<int, int> sizes_;     // nodes of each surface of this rank
  std::vector<int> sent_;        // positions in nodes_, grouped by receiver
  std::vector<Place> received_;
  std::vector<int> send_counts_, receive_counts_;    // nodes, by rank
};

}    // namespace biem

#endif
