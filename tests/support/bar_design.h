// A bar of fixed topology, for tests of maps of shapes: the same nodes, elements and triangles in
// the same order, whatever its parameters, as customers' evaluators give.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "common/fields/design_fields.h"

namespace mortise::testing {

// "stress" of the bar at a place along it, 0 to 1: bends with x.
inline double BarStress(double x, double y, double along) {
  return 1e6 * (1 + along * std::exp(x) + 0.1 * y);
}

// A bar along x, 1 + x long, y / 10 wide and 0.2 high, of `cells` cells along it, each six
// tetrahedra. Fields: "stress" at nodes in the load case "pull", "heat" of elements, x everywhere.
// Regions: "end", the far face.
inline fields::DesignFields BarDesign(double x, double y, int cells = 3) {
  fields::DesignFields design;
  const int count = 4 * (cells + 1);
  design.nodes.resize(3, count);
  Eigen::MatrixXd stress(1, count);
  for (int i = 0; i < count; ++i) {
    const double along = static_cast<double>(i / 4) / cells;
    design.nodes.col(i) << (1 + x) * along, (i % 2) * y / 10, (i / 2 % 2) * 0.2;
    stress(0, i) = BarStress(x, y, along);
  }
  // Kuhn's subdivision: from the lowest to the highest corner along the axes in every order.
  const std::array<std::array<int, 3>, 6> orders = {
      {{4, 1, 2}, {1, 2, 4}, {2, 4, 1}, {1, 4, 2}, {4, 2, 1}, {2, 1, 4}}};
  design.tetrahedra.resize(4, 6 * cells);
  for (int cell = 0; cell < cells; ++cell) {
    for (int t = 0; t < 6; ++t) {
      const std::array<int, 3>& order = orders[static_cast<std::size_t>(t)];
      const int a = 4 * cell, b = a + order[0], c = b + order[1], d = c + order[2];
      const bool is_right = t < 3;
      design.tetrahedra.col(6 * cell + t) << a, (is_right ? b : c), (is_right ? c : b), d;
    }
  }
  design.tetrahedron_part = Eigen::VectorXi::Zero(6 * cells);
  std::map<std::array<int, 3>, std::array<int, 3>> outside;  // triangles by their sorted nodes
  for (int e = 0; e < 6 * cells; ++e) {
    for (const auto& face : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
      std::array<int, 3> nodes{};
      for (std::size_t k = 0; k < 3; ++k) nodes[k] = design.tetrahedra(face[k], e);
      std::array<int, 3> key = nodes;
      std::ranges::sort(key);
      if (!outside.emplace(key, nodes).second) outside.erase(key);
    }
  }
  design.parts = {"bar"};
  design.triangles.resize(3, static_cast<int>(outside.size()));
  fields::Region end{"end", {}};
  int n = 0;
  for (const auto& [key, nodes] : outside) {
    if (key[0] >= 4 * cells) end.triangles.push_back(n);
    design.triangles.col(n++) << nodes[0], nodes[1], nodes[2];
  }
  design.triangle_back = Eigen::VectorXi::Zero(n);
  design.triangle_front = Eigen::VectorXi::Constant(n, -1);
  design.regions = {end};
  design.fields = {
      {"stress", "Pa", "pull", fields::FieldPlace::kNodes, stress},
      {"heat", "K", "", fields::FieldPlace::kElements, Eigen::MatrixXd::Constant(1, 6 * cells, x)}};
  return design;
}

}  // namespace mortise::testing
