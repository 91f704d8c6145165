// Finds parts that run into each other: what cannot be built.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/mesh/repair/proximity.h"
#include "common/mesh/shapes/box_stretch.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// m. Parts may reach into each other by as much.
inline constexpr double kMaxOverlap = 1e-4;

// Returns how much two boxes have in common along the axis along which that is least, m; less than
// 0 if they are apart.
double CommonDepth(const parametric::BoundingBox& a, const parametric::BoundingBox& b);

// Returns a length, m, for people: "3.25 mm". It is rounded to a hundredth of a millimetre, so that
// what is the same but for rounding reads the same.
std::string Millimetres(double metres);

// A part where it is, as what fills space there.
class SolidPart {
 public:
  // A part without a shape fills its box.
  SolidPart(std::string name, const parametric::BoundingBox& box,
            std::shared_ptr<const mesh::DrawnShape> shape, mesh::BoxStretch stretch);
  explicit SolidPart(const parametric::AssemblyPart& part);

  const std::string& name() const { return name_; }
  const parametric::BoundingBox& box() const { return box_; }

  // Returns how deep the parts reach into each other, m; 0 if they do not by more than
  // kMaxOverlap. Boxes by how far one must be moved to be free; shapes by their true surfaces,
  // less what their triangles may miss.
  static double DepthOf(const SolidPart& a, const SolidPart& b);

 private:
  const mesh::ProbedSurface& Probed() const;

  std::string name_;
  parametric::BoundingBox box_;
  std::shared_ptr<const mesh::DrawnShape> shape_;
  mesh::BoxStretch stretch_;
  mutable std::optional<mesh::ProbedSurface> probed_;
};

// Returns all parts of a design as they are now, the shift included. O(parts).
std::vector<SolidPart> SolidsOf(const Design& design);

}  // namespace mortise::composer
