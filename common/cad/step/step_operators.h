// Takes account of operators in STEP files that mirror or scale what they place. Private to this
// folder: it brings Open CASCADE.
//
// The kernel's locations are rigid: it drops the scale of a CARTESIAN_TRANSFORMATION_OPERATOR_3D,
// and turns what one mirrors. So operators are made rigid before the shapes are, and what they mean
// is looked up by the location that came of them.
#pragma once

#include <Eigen/Geometry>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Transient.hxx>
#include <TopLoc_Datum3D.hxx>
#include <TopLoc_Location.hxx>
#include <map>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::cad {

class StepOperators {
 public:
  // Changes the operators of mapped items and of assemblies in the reader's model.
  // INVALID_ARGUMENT, "step", for operators whose axes span no frame or whose scale is not
  // positive.
  static absl::StatusOr<StepOperators> TakeFrom(STEPCAFControl_Reader& reader);

  // Finds the locations that came of the operators, once shapes are made.
  void FindLocations(STEPCAFControl_Reader& reader);

  // Whether the location neither mirrors nor scales.
  bool IsRigid(const TopLoc_Location& location) const;

  // Returns the placement from the frame of what stands there, m: a similarity.
  Eigen::Affine3d PlacementOf(const TopLoc_Location& location) const;

 private:
  // An occurrence or a mapped item, and what it does to its product before the rigid motion that
  // is left of its operator.
  struct User {
    Handle(Standard_Transient) entity;
    Eigen::Matrix3d distortion;
    bool is_reversed = false;  // whether the inverse of the operator counts
  };

  std::vector<User> users_;
  std::map<const TopLoc_Datum3D*, Eigen::Affine3d> placements_;  // instead of the rigid one
  std::vector<TopLoc_Location> kept_;                            // so that data stay where they are
};

}  // namespace mortise::cad
