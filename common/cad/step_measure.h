// Measures solids of STEP files. Private to this folder: it brings Open CASCADE.
#pragma once

#include <Eigen/Geometry>
#include <TopoDS_Shape.hxx>
#include <vector>

#include "common/cad/step_assembly.h"

namespace mortise::cad {

// Boxes and volumes of one product's solid wherever it stands; what two placements have in common
// is computed once.
class SolidMeasurer {
 public:
  // `solid` is in the product's frame.
  explicit SolidMeasurer(const TopoDS_Shape& solid);

  // Fills in volume, box and is_box of a part that stands at `placement` in the assembly's frame.
  void Measure(const Eigen::Isometry3d& placement, StepPart& part);

 private:
  struct Turned {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d minimum, maximum;  // of the solid turned so, where it stands otherwise
  };
  const Turned& BoxOf(const Eigen::Matrix3d& rotation);

  TopoDS_Shape solid_;
  double volume_ = 0;
  bool is_polyhedron_ = false;  // flat faces, straight edges: its vertices span its box
  Eigen::Matrix3Xd vertices_;   // m, of a polyhedron
  std::vector<Turned> turned_;
};

}  // namespace mortise::cad
