// Sheets, strips and rods down to a 2000th as thick as long, and how they bend.
#pragma once

#include <algorithm>

#include "common/fem/problems/elasticity.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {

struct ThinBody {
  const char* name;
  Eigen::Vector3d size;  // m: length, width, thickness
  Eigen::Vector3i cells;
};

inline constexpr double kThinCurvature = 0.05;  // 1/m
inline constexpr double kThinModulus = 210e9;   // Pa

inline const ThinBody kThinBodies[] = {
    {"Sheet100", {1, 0.8, 1e-2}, {10, 8, 1}},   {"Sheet1000", {1, 0.8, 1e-3}, {10, 8, 1}},
    {"Sheet2000", {1, 0.8, 5e-4}, {10, 8, 1}},  {"Rod100", {1, 1e-2, 1e-2}, {40, 1, 1}},
    {"Rod1000", {1, 1e-3, 1e-3}, {80, 1, 1}},   {"Rod2000", {1, 5e-4, 5e-4}, {80, 1, 1}},
    {"Strip2000", {1, 2e-2, 5e-4}, {60, 2, 1}},
};

inline mesh::TetrahedralMesh MeshOf(const ThinBody& body, bool quadratic, int finer = 1) {
  mesh::MappedBox box;
  for (int k = 0; k < 3; ++k) box.ticks[k] = mesh::Ticks(finer * body.cells[k]);
  box.place = [size = body.size](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    return size.cwiseProduct(uvw);
  };
  return mesh::MeshMappedBox(box, quadratic);
}

// Clamped at one end and bent by a moment at the other, without Poisson's effect: u = (-κ x z, 0,
// κ x² / 2), z from the middle, which quadratic elements hold exactly.
inline AnalysisCase EndMoment(const ThinBody& body) {
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  analysis.materials[0].poissons_ratio = 0;
  analysis.supports = {{{0, "u_min"}}};
  analysis.tractions = {
      {{0, "u_max"},
       [middle = 0.5 * body.size.z()](const Eigen::Vector3d& p, const Eigen::Vector3d&) {
         return Eigen::Vector3d(-kThinModulus * kThinCurvature * (p.z() - middle), 0, 0);
       }}};
  return analysis;
}

// The largest error of a displacement, as a share of the largest displacement.
inline double ErrorOfBending(const ThinBody& body, const mesh::TetrahedralMesh& mesh,
                             const Eigen::Matrix3Xd& displacement) {
  double worst = 0;
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const Eigen::Vector3d p = mesh.nodes.col(v);
    const Eigen::Vector3d exact(-kThinCurvature * p.x() * (p.z() - 0.5 * body.size.z()), 0,
                                0.5 * kThinCurvature * p.x() * p.x());
    worst = std::max(worst, (displacement.col(v) - exact).norm());
  }
  return worst / (0.5 * kThinCurvature);
}

}  // namespace mortise::simulator
