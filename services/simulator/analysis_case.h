// How a meshed assembly is held and loaded.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "absl/status/status.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/simulator/material.h"

namespace mortise::simulator {

// Prescribes displacement on a face of a part, wherever it touches other parts or not.
struct Support {
  mesh::NamedFace face;
  std::array<bool, 3> fixed{true, true, true};             // which of x, y, z
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, of the fixed ones
};

// A total force spread evenly over the free area of a face.
struct FaceForce {
  mesh::NamedFace face;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N
};

// A pressure that pushes on the free area of a face, along its inward normal.
struct FacePressure {
  mesh::NamedFace face;
  double pressure = 0;  // Pa
};

// One load case. Parts that touch are bonded.
struct AnalysisCase {
  std::vector<Material> materials;  // one for each part
  std::vector<Support> supports;
  std::vector<FaceForce> forces;
  std::vector<FacePressure> pressures;
  Eigen::Vector3d gravity =
      Eigen::Vector3d::Zero();  // m/s², e.g. (0, 0, -9.80665); acts on all parts
};

// INVALID_ARGUMENT naming the field ("forces[1].face") if the case does not fit the mesh: a count
// of materials, an unusable material, a face that the mesh lacks, a load on a face that is wholly
// covered by other parts, a number that is not finite.
absl::Status CheckCase(const AnalysisCase& analysis, const mesh::TetrahedralMesh& mesh);

// Indices of the face triangles that lie on `face`; with `free_only`, just those on the outside.
std::vector<int> TrianglesOn(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                             bool free_only);

}  // namespace mortise::simulator
