// The periodic cell as packing needs it: fractional coordinates and the images within a distance.
// Any triclinic cell. Knows no atoms and no ranks.
#ifndef BIEM_MESH_LATTICE_H
#define BIEM_MESH_LATTICE_H

#include "biem_types.h"

#include <cmath>

namespace biem {

class MeshLattice {
 public:
  // vectors: lattice vectors in columns, length
  explicit MeshLattice(const Mat3 &vectors) : vectors_(vectors), inverse_(vectors.inverse())
  {
    for (int k = 0; k < 3; k++) height_[k] = 1.0 / inverse_.row(k).norm();
  }

  const Mat3 &vectors() const { return vectors_; }
  double compute_volume() const { return std::abs(vectors_.determinant()); }

  Vec3 compute_fractional(const Vec3 &point) const { return inverse_ * point; }

  // The image of a difference vector whose fractional components are within +-1/2: the shortest
  // one where it is short against the cell.
  Vec3 wrap_difference(const Vec3 &difference) const
  {
    const Vec3 s = inverse_ * difference;
    return difference - vectors_ * Vec3(std::round(s[0]), std::round(s[1]), std::round(s[2]));
  }

  // Calls visit(image) for every periodic image of the vector shorter than cutoff.
  template <class Visitor>
  void for_each_image(const Vec3 &difference, double cutoff, Visitor visit) const
  {
    const Vec3 base = wrap_difference(difference);
    int reach[3];
    for (int k = 0; k < 3; k++) reach[k] = static_cast<int>(cutoff / height_[k] + 0.5);
    for (int i = -reach[0]; i <= reach[0]; i++)
      for (int j = -reach[1]; j <= reach[1]; j++)
        for (int k = -reach[2]; k <= reach[2]; k++) {
          const Vec3 image = base + vectors_ * Vec3(i, j, k);
          if (image.squaredNorm() < cutoff * cutoff) visit(image);
        }
  }

  // Distance between opposite faces, by lattice vector.
  const Vec3 &heights() const { return height_; }

 private:
  Mat3 vectors_, inverse_;
  Vec3 height_;
};

}    // namespace biem

#endif
