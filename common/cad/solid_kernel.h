// The kernel's side of a solid. It brings Open CASCADE's headers: for cad and features alone.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <vector>

#include "common/cad/solid.h"
#include "common/cad/stretch_map.h"

namespace mortise::cad {

struct Solid::Kernel {
  std::string name;
  TopoDS_Shape shape;                   // one solid, m
  std::vector<TopoDS_Face> faces;       // in the order of mesh::PartShape::face_names
  std::vector<std::string> face_names;  // of each face

  // The solid before it was stretched unevenly (StretchSolid), if it was.
  struct Drawn {
    TopoDS_Shape shape;
    StretchMap map;
    double volume = 0;  // m³, stretched
  };
  std::optional<Drawn> stretched_from;
};

// Returns the volume, m³, to eight digits for whatever surfaces: the integral that the kernel takes
// by default misses up to a hundredth of solids bounded by splines. It is negative if the solid is
// inside out.
double AccurateVolume(const TopoDS_Shape& solid);

// The status of a failure inside Open CASCADE: INTERNAL, saying which operation failed and why.
absl::Status KernelFailure(const std::string& operation, const std::string& message);

}  // namespace mortise::cad
