// Measures solids of STEP files. For cad alone: it brings Open CASCADE.
#pragma once

#include <Eigen/Geometry>
#include <TopoDS_Shape.hxx>
#include <deque>
#include <utility>

#include "common/cad/solid_box.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

// Measures boxes and volumes of one product's solid wherever it stands. What two placements have in
// common is computed once.
class SolidMeasurer {
 public:
  // `solid` is in the product's frame.
  explicit SolidMeasurer(const TopoDS_Shape& solid);

  // Fills in volume, box and is_box of a part that stands at `placement` in the assembly's frame.
  void Measure(const Eigen::Isometry3d& placement, StepPart& part);

 private:
  // Returns the box of the solid turned so, before it is moved to its place.
  const SolidBox& TurnedBox(const Eigen::Matrix3d& rotation);

  TopoDS_Shape solid_;
  double volume_ = 0;
  std::deque<std::pair<Eigen::Matrix3d, SolidBox>> boxes_;  // by rotation
};

}  // namespace mortise::cad
