// Small assemblies with connecting parts, and what tests of connections ask about them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/connections/connection_optimizer.h"
#include "common/assembly/parametric_assembly.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {

inline AssemblyPart Fastener(const std::string& name, const Eigen::Vector3d& minimum,
                             const Eigen::Vector3d& maximum, int group = 0) {
  AssemblyPart part = FixedPart(name, minimum, maximum, group);
  part.item = "items/fastener-" + name.substr(0, name.find(' '));
  part.connecting = true;
  return part;
}

// A board 20 mm thick that stands on another, 0.6 m long, with six dowels of 8 x 30 mm between
// them: the outer ones 25 mm from the ends, 0.11 m apart, 12 mm deep in the lower board.
inline Assembly DowelledBoards() {
  Assembly boards;
  boards.name = "boards";
  boards.groups = {{"boards", -1}};
  boards.parts = {ResizablePart("bottom", {0, 0, 0}, {0.6, 0.1, 0.02}),
                  ResizablePart("wall", {0, 0.04, 0.02}, {0.6, 0.06, 0.22})};
  boards.parts[1].item = "items/panel";
  for (int i = 0; i < 6; ++i) {
    const double x = 0.025 + 0.11 * i;
    boards.parts.push_back(Fastener("dowel " + std::to_string(i + 1), {x - 0.004, 0.046, 0.008},
                                    {x + 0.004, 0.054, 0.038}));
  }
  return boards;
}

// A post on a sill with a strip that goes round their corner: screws of three kinds, a bracket
// outside of the contact, and a bolt with a washer under its nut.
inline Assembly BoltedCorner() {
  Assembly corner;
  corner.name = "corner";
  corner.groups = {{"corner", -1}, {"frame", 0}, {"hardware", 0}};
  corner.parts = {ResizablePart("sill", {0, 0, 0}, {0.5, 0.1, 0.05}, 1),
                  ResizablePart("post", {0.1, 0.01, 0.05}, {0.2, 0.09, 0.55}, 1),
                  Fastener("screw front", {0.12, 0.02, 0.01}, {0.126, 0.026, 0.08}, 2),
                  Fastener("screw back", {0.14, 0.07, 0.01}, {0.146, 0.076, 0.08}, 2),
                  Fastener("bracket", {0.2, 0.03, 0.05}, {0.24, 0.07, 0.09}, 2),
                  Fastener("bolt", {0.17, 0.04, 0}, {0.18, 0.05, 0.12}, 2),
                  Fastener("washer", {0.165, 0.035, -0.002}, {0.185, 0.055, 0}, 2)};
  corner.parts[1].item = "items/post";
  return corner;
}

inline ParametricAssembly ParametrizedDesign(Assembly assembly) {
  auto made = ParametricAssembly::Create(std::move(assembly));
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

// The boxes of a connection's principals in a design.
inline std::vector<BoundingBox> PrincipalsAt(const ElementConnection& connection,
                                             const Eigen::VectorXd& q) {
  std::vector<BoundingBox> boxes;
  for (const int element : connection.principals) boxes.push_back(BoxOf(q, element));
  return boxes;
}

// A connection's parameters as a design has them, its patches as the principals meet there.
inline Eigen::VectorXd ParametersIn(const ElementConnection& connection, std::size_t elements,
                                    const Eigen::VectorXd& q) {
  Eigen::VectorXd local = DrawnParameters(connection);
  Eigen::Index next = 0;
  for (const std::vector<int>* indices : {&connection.principals, &connection.connecting}) {
    for (const int element : *indices) {
      local.segment<6>(next) = q.segment<6>(6 * element);
      next += 6;
    }
  }
  for (const int joint : connection.joints) {
    local.segment<3>(next) = q.segment<3>(6 * static_cast<Eigen::Index>(elements) + 3 * joint);
    next += 3;
  }
  const std::vector<BoundingBox> principals = PrincipalsAt(connection, q);
  for (int patch = 0; patch < static_cast<int>(connection.patches.size()); ++patch) {
    const BoundingBox region = PatchAt(connection, patch, principals).region;
    local.segment<3>(next) = region.center();
    local.segment<3>(next + 3) = region.size();
    next += 6;
  }
  return local;
}

inline double HardResidual(const ElementConnection& connection, const Eigen::VectorXd& local) {
  double residual = 0;
  for (const Relationship& hard : connection.hard) {
    const double value = hard.form.At(local);
    residual = std::max(residual, hard.equality ? std::abs(value) : value);
  }
  return residual;
}

inline double SoftResidual(const ElementConnection& connection, const Eigen::VectorXd& local) {
  double squares = 0;
  for (const SoftRelationship& soft : connection.soft) {
    squares += std::pow(soft.weight * soft.form.At(local), 2);
  }
  return std::sqrt(squares);
}

inline const ElementConnection& Only(const ParametricAssembly& design) {
  EXPECT_EQ(design.connections().size(), 1U);
  return design.connections().front();
}

inline void ExpectBox(const BoundingBox& box, const Eigen::Vector3d& minimum,
                      const Eigen::Vector3d& maximum) {
  EXPECT_LT((box.minimum - minimum).norm(), 1e-9) << box.minimum.transpose();
  EXPECT_LT((box.maximum - maximum).norm(), 1e-9) << box.maximum.transpose();
}

}  // namespace mortise::parametric
