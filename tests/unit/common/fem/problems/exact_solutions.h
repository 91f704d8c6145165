// Displacements that are known everywhere, for tests of convergence.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "common/fem/problems/elasticity.h"
#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {

// u = a sin πx sin πy sin πz on the cube 0 … 1, zero on its faces, and the body force that makes it
// so in an isotropic material: −(λ + μ) ∇(∇·u) − μ ∇²u.
struct BubbleSolution {
  Material material{"test", 1000, 2.5, 0.25, 0};
  Eigen::Vector3d a{1e-2, -2e-2, 1.5e-2};

  static Eigen::Array3d Sines(const Eigen::Vector3d& x) { return (M_PI * x.array()).sin(); }
  static Eigen::Array3d Cosines(const Eigen::Vector3d& x) { return (M_PI * x.array()).cos(); }

  Eigen::Vector3d Displacement(const Eigen::Vector3d& x) const { return a * Sines(x).prod(); }

  Eigen::Matrix3d Gradient(const Eigen::Vector3d& x) const {
    const Eigen::Array3d s = Sines(x), c = Cosines(x);
    const Eigen::Vector3d slope(c[0] * s[1] * s[2], s[0] * c[1] * s[2], s[0] * s[1] * c[2]);
    return M_PI * a * slope.transpose();
  }

  Eigen::Vector3d BodyForce(const Eigen::Vector3d& x) const {
    const Eigen::Array3d s = Sines(x), c = Cosines(x);
    Eigen::Matrix3d second;  // of the product of sines, over π²
    second.diagonal().setConstant(-s.prod());
    second(0, 1) = second(1, 0) = c[0] * c[1] * s[2];
    second(1, 2) = second(2, 1) = s[0] * c[1] * c[2];
    second(0, 2) = second(2, 0) = c[0] * s[1] * c[2];
    const double lambda = material.Lambda(), mu = material.Mu();
    return M_PI * M_PI * (3 * mu * s.prod() * a - (lambda + mu) * second * a);
  }

  AnalysisCase Case() const {
    AnalysisCase analysis;
    analysis.materials = {material};
    for (const char* face : {"u_min", "u_max", "v_min", "v_max", "w_min", "w_max"}) {
      analysis.supports.push_back({{0, face}});
    }
    analysis.body_force = [*this](const Eigen::Vector3d& x) { return BodyForce(x); };
    return analysis;
  }
};

// A mesh of n³ cells of the cube; they are a little uneven inside.
inline mesh::TetrahedralMesh CubeMesh(int n, bool quadratic) {
  mesh::MappedBox box;
  box.ticks = {mesh::Ticks(n), mesh::Ticks(n), mesh::Ticks(n)};
  box.place = [](const Eigen::Vector3d& p) {
    const Eigen::Array3d s = BubbleSolution::Sines(p);
    return Eigen::Vector3d(p + 0.1 * s.prod() * Eigen::Vector3d(1, -0.5, 0.7));
  };
  return mesh::MeshMappedBox(box, quadratic);
}

// Errors of a displacement of the mesh against the exact one.
struct TrueError {
  double displacement = 0;  // √∫ |u − uₕ|² dV
  double energy = 0;        // √∫ (ε − εₕ)ᵀ D (ε − εₕ) dV
};
TrueError MeasureError(const mesh::TetrahedralMesh& mesh, const BubbleSolution& exact,
                       const Eigen::Matrix3Xd& displacement);

}  // namespace mortise::simulator
