// Tells how the von Mises stress is spread over the volume of a body: integrals, means and
// percentiles. Other than the largest stress at any node they do not grow without end with
// refinement at sharp inner corners, as little volume is there, and hardly scatter from mesh to
// mesh. The integral over the volume is what the thesis optimises (§6.7.1).
//
// The stress is that of the elements themselves at the points of a quadrature rule, and so exact
// wherever displacements are: under uniform stress and, with quadratic elements, in bending, but
// for the elements in which stress changes its sign.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/linear/thread_team.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// The von Mises stress at points all over a body, and the volume that each of them stands for.
struct StressSpread {
  Eigen::VectorXd von_mises;  // points, Pa
  Eigen::VectorXd volume;     // points, m³

  double Volume() const { return volume.sum(); }  // m³
  // ∫ σ dV, Pa m³ = N m.
  double Integral() const { return von_mises.dot(volume); }
  // ∫ σ dV / V, Pa.
  double Mean() const { return Integral() / Volume(); }
  // √(∫ σ² dV / V), Pa: the more above the mean, the less evenly the stress is spread.
  double RootMeanSquare() const;
  // Returns the stress, Pa, that `share` (0 to 1) of the volume does not exceed: that of the point
  // in whose volume the share is reached. There must be points. O(n log n) of n points.
  double Percentile(double share) const;
};

// Returns the spread over all parts, points of an element in a row: one for linear elements, whose
// stress is the same all over, fourteen for quadratic ones. `temperature`: nodes, K above that of
// no stress, or empty. The same for any number of threads.
StressSpread SpreadOf(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                      const Eigen::Matrix3Xd& displacement, const Eigen::VectorXd& temperature,
                      ThreadTeam& team);

// Returns what of a body's spread is that of one of its parts; empty where no element is.
StressSpread SpreadInPart(const mesh::TetrahedralMesh& mesh, const StressSpread& spread, int part);

// What may be asked of a spread and has a gradient.
enum class SpreadMeasure { kIntegral, kMean, kRootMeanSquare };

// Returns the measure, Pa or Pa m³.
double ValueOf(SpreadMeasure measure, const StressSpread& spread);

// A measure, and its derivatives by displacements and places of nodes.
struct SpreadDerivative {
  double value = 0;
  Eigen::Matrix3Xd by_displacement;  // 3 × nodes
  Eigen::Matrix3Xd by_position;      // 3 × nodes
};

// Returns the measure over a part, or over all where `part` is -1, of a body that is not warm. A
// point without stress, where von Mises stress has no derivative, adds nothing to those by
// displacement. O(elements).
SpreadDerivative DerivativeOf(SpreadMeasure measure, const mesh::TetrahedralMesh& mesh,
                              const std::vector<Material>& materials,
                              const Eigen::Matrix3Xd& displacement, int part, ThreadTeam& team);

}  // namespace mortise::simulator
