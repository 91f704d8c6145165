// Assemblies of boards that touch, at two parameters each, for tests of mappings: flush faces, ends
// on faces, and corners on corners.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/interpolator/mapping/model_surface_map.h"

namespace mortise::interpolator {

struct Board {
  std::string name;
  Eigen::Vector3d low, high;  // m
};

struct BoardAssembly {
  std::string name;
  // Whether boards meet in an edge alone: what is named there may be on either side of it.
  bool meets_in_edges = false;
  std::vector<Board> source, target;  // the same boards
};

std::vector<BoardAssembly> BoardAssemblies();

struct BoardSurface {
  mesh::AssemblySurface assembly;
  // With the vertices where three or more faces of boards meet, and the edges between, by the names
  // of the faces.
  ModelSurface model;
};

absl::StatusOr<BoardSurface> Fused(const std::vector<Board>& boards);

// Returns how far vertices are at most from the planes of the faces that their triangles lie on,
// when these are the faces of `boards`.
double FarthestOffFaces(const std::vector<Board>& boards, const mesh::AssemblySurface& assembly,
                        const Eigen::Matrix3Xd& positions);

// The same of the nodes on the outside of a mesh.
double FarthestOffFaces(const std::vector<Board>& boards, const mesh::TetrahedralMesh& mesh,
                        const Eigen::Matrix3Xd& nodes);

}  // namespace mortise::interpolator
