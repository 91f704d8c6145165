// Computes how stiffness, loads and means over faces change when the nodes of a mesh move and its
// elements stay the same: the exact derivatives of the discrete quantities, in closed form.
//
// Notation: V is the velocity of the nodes, G = ∇V in space. Of an isoparametric element,
//   δ(dV) = tr(G) dV,  δ(∇u) = −∇u G,
// so that with stresses σ(u) = D ε(u)
//   δ(λᵀ K u) = Σ ∫ [tr(G) σ(u):ε(λ) − σ(u):(∇λ G) − σ(λ):(∇u G)] dV,
// the material's directions staying where they are (Haslinger and Mäkinen, Introduction to Shape
// Optimization, SIAM 2003, chapter 3). Everything is linear in V: results are the factors of the
// nodes' velocities, 3 × nodes, whatever the number of parameters that move them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/analysis_case.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Returns d(λᵀ K u)/dX. There is one of `materials` for each part.
Eigen::Matrix3Xd StiffnessDerivative(const mesh::TetrahedralMesh& mesh,
                                     const std::vector<Material>& materials,
                                     const Eigen::Matrix3Xd& displacement,
                                     const Eigen::Matrix3Xd& adjoint);

// Returns d(λᵀ f)/dX of the forces, pressures and gravity of a load case, whose numbers stay the
// same.
Eigen::Matrix3Xd LoadDerivative(const mesh::TetrahedralMesh& mesh,
                                const std::vector<Material>& materials, const LoadCase& loads,
                                const Eigen::Matrix3Xd& adjoint);

// The area of triangles, m², and its derivative by the nodes' positions.
struct FaceArea {
  double value = 0;
  Eigen::Matrix3Xd by_position;  // 3 × nodes
};
FaceArea AreaOfTriangles(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles);

// The mean of direction · u over triangles, and its derivatives by u and by the nodes' positions.
struct FaceMean {
  double value = 0;
  Eigen::Matrix3Xd by_field;     // 3 × nodes
  Eigen::Matrix3Xd by_position;  // 3 × nodes
};
FaceMean MeanOverTriangles(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles,
                           const Eigen::Matrix3Xd& field, const Eigen::Vector3d& direction);

// Returns the mean of the length of u likewise; a point where it is 0 adds nothing to the
// derivatives.
FaceMean MeanLengthOverTriangles(const mesh::TetrahedralMesh& mesh,
                                 const std::vector<int>& triangles, const Eigen::Matrix3Xd& field);

// Returns d(mass)/dX, kg/m, of parts with these densities.
Eigen::Matrix3Xd MassDerivative(const mesh::TetrahedralMesh& mesh,
                                const std::vector<double>& densities);

}  // namespace mortise::simulator
