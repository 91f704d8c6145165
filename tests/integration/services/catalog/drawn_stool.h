// A stool as its STEP file, and solids to draw others with.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/cad/cylinder.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"

namespace mortise::catalog {

inline cad::Solid Prism(const std::string& name, const Eigen::Matrix2Xd& outline, double height) {
  mesh::PartShape shape;
  shape.name = name;
  shape.outline = outline;
  shape.height = height;
  for (Eigen::Index i = 0; i < outline.cols() + 2; ++i) {
    shape.face_names.push_back(absl::StrCat("face", i));
  }
  return *cad::Solid::FromPart(shape);
}

inline cad::Solid Box(const std::string& name, const Eigen::Vector3d& size) {
  Eigen::Matrix2Xd outline(2, 4);
  outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
  return Prism(name, outline, size.z());
}

// An L of 40 × 40 mm, 4 mm thick.
inline cad::Solid Bracket(double length) {
  Eigen::Matrix2Xd outline(2, 6);
  outline << 0, 0.04, 0.04, 0.004, 0.004, 0, 0, 0, 0.004, 0.004, 0.04, 0.04;
  return Prism("bracket", outline, length);
}

inline cad::Solid Leg() {
  cad::CylinderShape leg;
  leg.name = "leg";
  leg.radius_u = leg.radius_v = 0.02;
  leg.center = Eigen::Vector3d(0.02, 0.02, 0);
  leg.height = 0.4;
  return *cad::MakeCylinder(leg);
}

inline void Place(cad::StepAssembly& assembly, const std::string& name, int group, int product,
                  const Eigen::Vector3d& at) {
  cad::StepPart part;
  part.name = name;
  part.group = group;
  part.product = product;
  part.placement.translation() = at;
  assembly.parts.push_back(std::move(part));
}

// A board on two round legs; against one leg's top a bracket that the board lies on, and in the
// bracket's corner a block that it touches nowhere, though its box holds it.
inline std::string Stool() {
  cad::StepAssembly stool;
  stool.name = "stool";
  stool.groups = {{"stool", -1}, {"legs", 0}};
  stool.products = {{"board", Box("board", {0.5, 0.04, 0.02}), Eigen::Vector3d(0.5, 0.25, 0.125)},
                    {"leg", Leg(), std::nullopt},
                    {"bracket", Bracket(0.03), std::nullopt},
                    {"block", Box("block", {0.03, 0.03, 0.03}), std::nullopt}};
  Place(stool, "board", 0, 0, {0, 0, 0.4});
  Place(stool, "left leg", 1, 1, {0, 0, 0});
  Place(stool, "right leg", 1, 1, {0.46, 0, 0});
  Place(stool, "bracket", 0, 2, {0.2, 0, 0.37});
  Place(stool, "block", 0, 3, {0.206, 0.006, 0.37});
  return *cad::WriteStep(stool);
}

}  // namespace mortise::catalog
