// Says where points of a drawn solid go when it is stretched along the axes, in proportion or in
// pieces between levels (mesh/shapes/box_stretch.h). For cad alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/mesh/shapes/box_stretch.h"

namespace mortise::cad {

// A map by which p becomes factors ∘ p + offsets.
struct AffineStretch {
  Eigen::Vector3d factors = Eigen::Vector3d::Ones();
  Eigen::Vector3d offsets = Eigen::Vector3d::Zero();  // m
};

class StretchMap {
 public:
  // Makes a map by which p becomes factors ∘ p; factors > 0.
  explicit StretchMap(const Eigen::Vector3d& factors) : whole_{factors, Eigen::Vector3d::Zero()} {}

  // Makes the map from a box of this size, m, to that of `stretch`, both with their lower corner at
  // the origin. Levels at which the slope does not change are left out.
  StretchMap(const Eigen::Vector3d& drawn_size, const mesh::BoxStretch& stretch);

  bool IsInProportion() const;
  // Returns the factors of a map in proportion.
  const Eigen::Vector3d& factors() const { return whole_.factors; }
  double MostFactor() const;

  // Returns where a place along an axis goes, m. Beyond the ends the map goes on as at them.
  double At(int axis, double drawn) const;

  // Returns the map of something that reaches from one corner to another, m. Along an axis where it
  // lies in one piece, to a millionth of the box, it is that piece's; else the one that takes its
  // ends to the right places.
  AffineStretch Of(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;

  // Whether something reaches across several pieces of an axis.
  bool IsAcross(int axis, double low, double high) const;

 private:
  struct Knot {
    double drawn = 0, place = 0;  // m
  };

  // Returns the piece in which a place is: between knots `index` and `index` + 1.
  std::size_t PieceOf(int axis, double drawn) const;
  bool IsIn(int axis, std::size_t piece, double low, double high) const;
  const std::vector<Knot>& Knots(int axis) const { return knots_[static_cast<std::size_t>(axis)]; }

  AffineStretch whole_;                     // where an axis has no pieces
  std::array<std::vector<Knot>, 3> knots_;  // with the ends of the box; empty for one piece
};

}  // namespace mortise::cad
