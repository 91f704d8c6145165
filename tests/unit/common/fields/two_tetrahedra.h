// A design of two parts that touch, each a tetrahedron, with everything that a file can hold.
#pragma once

#include "common/fields/design_fields.h"

namespace mortise::fields {

inline DesignFields TwoTetrahedra() {
  DesignFields design;
  design.nodes.resize(3, 5);
  design.nodes << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1;
  design.nodes *= 0.123456789;
  design.tetrahedra.resize(4, 2);
  design.tetrahedra << 0, 1, 1, 4, 2, 2, 3, 3;
  design.tetrahedron_part = Eigen::Vector2i(0, 1);
  design.triangles.resize(3, 7);
  design.triangles << 0, 0, 0, 1, 1, 2, 1,  //
      2, 1, 3, 2, 4, 4, 3,                  //
      1, 3, 2, 3, 2, 3, 4;
  design.triangle_back.resize(7);
  design.triangle_back << 0, 0, 0, 0, 1, 1, 1;
  design.triangle_front.resize(7);
  design.triangle_front << -1, -1, -1, 1, -1, -1, -1;
  design.parts = {"leg", "Platte – 2"};
  design.regions = {{"held", {0, 2}}, {"leg/base", {0}}, {"nothing", {}}};
  design.control_points = {{"V1", Eigen::Vector3d(0, 0, 0), 0}, {"V2", {0.5, 0.25, -1}, -1}};
  design.paths = {{"E1", {0, 1, 3, 0}}};
  Eigen::Matrix3Xd bend(3, 3);
  bend << 0, 0.1, 0.5, 0, 0.25, 0.25, 0, 1e-300, -1;
  design.ways = {{"E2", 0, 1, bend}, {"E2", 1, 0, Eigen::Matrix3Xd::Identity(3, 2)}};
  Eigen::MatrixXd displacement(3, 5);
  displacement << 1e-6, 2e-6, 3e-6, 4e-6, 5e-6, -1, -2, -3, -4, -5, 0, 0, 0, 0, 1e-300;
  design.fields = {
      {"displacement", "m", "own weight", FieldPlace::kNodes, displacement},
      {"displacement", "m", "wind", FieldPlace::kNodes, 2 * displacement},
      {"heat_flux", "W/m^2", "", FieldPlace::kElements, Eigen::MatrixXd::Constant(3, 2, 17.25)}};
  return design;
}

}  // namespace mortise::fields
