// Says how a meshed assembly is held and loaded.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/fem/elements/material.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// A support prescribes displacement on a face of a part, wherever it touches other parts or not,
// or of nodes.
struct Support {
  mesh::NamedFace face;                         // without a name: `nodes` are held instead
  std::array<bool, 3> fixed{true, true, true};  // which of x, y, z
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, of the fixed ones
  // Holds the displacement along the face's own normal, whichever way that points, and nothing
  // else: a plane of symmetry, or a smooth guide. `fixed` and `displacement` are not looked at.
  bool symmetric = false;
  std::vector<int> nodes{};  // of the mesh, where there is no face
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

// A traction that varies over the free area of a face.
struct FaceTraction {
  mesh::NamedFace face;
  // Force per area, Pa, at a position (m) where the outward normal has length 1.
  std::function<Eigen::Vector3d(const Eigen::Vector3d& position, const Eigen::Vector3d& normal)>
      traction;
};

// A force at a point in the body, shared among the nodes of the element there. Stress near it has
// no limit under refinement; displacement elsewhere has.
struct PointForce {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N
};

// A force at a node.
struct NodalForce {
  int node = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N
};

// Turning at a constant speed about an axis, seen from the turning body: the centrifugal load
// −ρ ω × (ω × r).
struct Rotation {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();             // m, on the axis
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s, along the axis
};

// Loads that act together.
struct LoadCase {
  std::vector<FaceForce> forces;
  std::vector<FacePressure> pressures;
  Eigen::Vector3d gravity =
      Eigen::Vector3d::Zero();  // m/s², e.g. (0, 0, -9.80665); acts on all parts
  std::vector<FaceTraction> tractions;
  std::vector<PointForce> point_forces;
  std::vector<NodalForce> nodal_forces;
  std::optional<Rotation> rotation;
  // Force per volume, N/m³, at a position; none if empty.
  std::function<Eigen::Vector3d(const Eigen::Vector3d& position)> body_force;
  // The temperature of each node, K above the one at which nothing is under stress; empty if none
  // is.
  Eigen::VectorXd temperature;
};

// A load case by name.
struct NamedLoadCase {
  std::string name;
  LoadCase loads;
  bool thermal_stress = false;  // whether the temperatures of the model's heat act
};

// One load case and what it acts on. Parts that touch are bonded.
struct AnalysisCase : LoadCase {
  std::vector<Material> materials;  // one for each part
  std::vector<Support> supports;
};

// Fails with INVALID_ARGUMENT naming the field ("materials[1].density", "supports[0].face") if
// there is not one usable material for each part, or a support is on a face that the mesh lacks.
absl::Status CheckModel(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                        const std::vector<Support>& supports);

// Fails with INVALID_ARGUMENT naming the field ("forces[1].face") if a load is on a face that the
// mesh lacks or that is wholly covered by other parts, is not finite, or has the wrong number of
// temperatures.
absl::Status CheckLoads(const mesh::TetrahedralMesh& mesh, const LoadCase& loads);

// Returns the indices of the face triangles that lie on `face`; with `free_only`, just those on the
// outside.
std::vector<int> TrianglesOn(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                             bool free_only);

// Fails with INVALID_ARGUMENT naming `field` unless the mesh has `face`, with `free_only` on its
// outside.
absl::Status CheckFace(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                       bool free_only, const std::string& field);

}  // namespace mortise::simulator
