// Assemblies for tests of STEP: boxes, an angle and a cylinder under nested groups that are turned.
#pragma once

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

// A prism on the outline (x, y, m), with its first corner at the origin.
inline Solid Prism(const std::string& name, const Eigen::Matrix2Xd& outline, double height) {
  mesh::PartShape shape;
  shape.name = name;
  shape.outline = outline;
  shape.height = height;
  for (Eigen::Index i = 0; i < outline.cols() + 2; ++i) {
    shape.face_names.push_back(absl::StrCat("face", i));
  }
  return *Solid::FromPart(shape);
}

inline Solid Box(const std::string& name, double x, double y, double z) {
  Eigen::Matrix2Xd outline(2, 4);
  outline << 0, x, x, 0, 0, 0, y, y;
  return Prism(name, outline, z);
}

inline Solid Angle(const std::string& name) {
  Eigen::Matrix2Xd outline(2, 6);
  outline << 0, 0.04, 0.04, 0.004, 0.004, 0, 0, 0, 0.004, 0.004, 0.04, 0.04;
  return Prism(name, outline, 0.03);
}

inline Solid Cylinder(const std::string& name, double radius, double height) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  kernel->shape = BRepPrimAPI_MakeCylinder(radius, height).Solid();
  return Solid(std::move(kernel));
}

inline Eigen::Isometry3d At(double x, double y, double z, double angle = 0,
                            const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
  return Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(angle, axis.normalized());
}

inline void AddPart(StepAssembly& assembly, const std::string& name, int group, int product,
                    const Eigen::Isometry3d& placement) {
  StepPart part;
  part.name = name;
  part.group = group;
  part.product = product;
  part.placement = placement;
  assembly.parts.push_back(std::move(part));
}

// A stand with two frames, one of which is turned and holds a tilted bracket.
inline StepAssembly Stand() {
  StepAssembly stand;
  stand.name = "stand";
  stand.groups = {{"stand", -1, At(0, 0, 0)},
                  {"left", 0, At(0.1, 0.2, 0)},
                  {"right", 0, At(1.1, 0.2, 0.05, 0.3)},
                  {"bracket", 2, At(0.01, 0.02, 0.03, 0.7, {1, 2, 3})}};
  stand.products = {{"post", Box("post", 0.038, 0.089, 0.7), Eigen::Vector3d(0.5, 0.25, 0.125)},
                    {"angle", Angle("angle"), std::nullopt},
                    {"pin", Cylinder("pin", 0.005, 0.04), Eigen::Vector3d(0.25, 0.25, 0.5)}};
  AddPart(stand, "front post", 1, 0, At(0, 0, 0));
  AddPart(stand, "rear post", 1, 0, At(0, 0.4, 0));
  AddPart(stand, "turned post", 2, 0, At(0, 0, 0));
  AddPart(stand, "lying post", 0, 0, At(0, 0, 1, std::numbers::pi / 2, {0, 1, 0}));
  AddPart(stand, "angle", 3, 1, At(0, 0, 0));
  AddPart(stand, "pin", 3, 2, At(0.02, 0.02, 0, 0.2, {1, 0, 0}));
  AddPart(stand, "stop", 0, 2, At(0.5, 0.5, 0));
  stand.parts.back().color = Eigen::Vector3d(1, 0, 0);
  return stand;
}

}  // namespace mortise::cad
