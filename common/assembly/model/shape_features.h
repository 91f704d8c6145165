// Remembers what shapes are found to have, so that each is looked at once: many parts share one,
// and each round of parametrisation asks again.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/mesh/shapes/countersinks.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "common/mesh/shapes/round_faces.h"
#include "common/mesh/shapes/shape_levels.h"
#include "common/mesh/shapes/slots.h"

namespace mortise::parametric {

// Shapes are known by their address, and must outlive this. It is not for several threads at once.
class ShapeFeatures {
 public:
  const std::vector<mesh::RoundFace>& RoundFacesOf(const mesh::DrawnShape& shape);
  const std::vector<mesh::Countersink>& CountersinksOf(const mesh::DrawnShape& shape);
  const std::vector<mesh::Slot>& SlotsOf(const mesh::DrawnShape& shape);
  const std::vector<mesh::ShapeLevel>& LevelsOf(const mesh::DrawnShape& shape);
  // Returns the axis of the shape's box, 0, 1 or 2, that it may be turned about without reaching
  // further. The shape lies in a cylinder about that axis, part of which is one of its faces, and
  // which is as wide as the box.
  std::optional<int> RoundAboutOf(const mesh::DrawnShape& shape);

 private:
  std::map<const mesh::DrawnShape*, std::vector<mesh::RoundFace>> round_faces_;
  std::map<const mesh::DrawnShape*, std::vector<mesh::Countersink>> countersinks_;
  std::map<const mesh::DrawnShape*, std::vector<mesh::Slot>> slots_;
  std::map<const mesh::DrawnShape*, std::vector<mesh::ShapeLevel>> levels_;
  std::map<const mesh::DrawnShape*, std::optional<int>> round_about_;
};

}  // namespace mortise::parametric
