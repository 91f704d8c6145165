// What shapes are found to have, each looked at once: many parts share one, and each round of
// parametrisation asks again.
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

// Shapes are known by their address, and are to outlive this. Not for several threads at once.
class ShapeFeatures {
 public:
  const std::vector<mesh::RoundFace>& RoundFacesOf(const mesh::DrawnShape& shape);
  const std::vector<mesh::Countersink>& CountersinksOf(const mesh::DrawnShape& shape);
  const std::vector<mesh::Slot>& SlotsOf(const mesh::DrawnShape& shape);
  const std::vector<mesh::ShapeLevel>& LevelsOf(const mesh::DrawnShape& shape);
  // The axis of its box, 0, 1 or 2, that it may be turned about without reaching further: it lies
  // in a cylinder about that, part of which is a face of it, and which is as wide as the box.
  std::optional<int> RoundAboutOf(const mesh::DrawnShape& shape);

 private:
  std::map<const mesh::DrawnShape*, std::vector<mesh::RoundFace>> round_faces_;
  std::map<const mesh::DrawnShape*, std::vector<mesh::Countersink>> countersinks_;
  std::map<const mesh::DrawnShape*, std::vector<mesh::Slot>> slots_;
  std::map<const mesh::DrawnShape*, std::vector<mesh::ShapeLevel>> levels_;
  std::map<const mesh::DrawnShape*, std::optional<int>> round_about_;
};

}  // namespace mortise::parametric
