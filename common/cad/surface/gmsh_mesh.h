// Has Gmsh, a program of its own (Debian's package gmsh), triangulate faces, and reads the
// triangles as it numbers and writes them. Private to this folder: it brings Open CASCADE.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Face.hxx>
#include <chrono>
#include <gp_XY.hxx>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::cad {

struct GmshPoint {
  Eigen::Vector3d place;         // m
  std::optional<gp_XY> on_face;  // of a point inside a face: where on it
};

struct GmshMesh {
  std::vector<GmshPoint> points;
  // The triangles of each face: corners by index of points, whichever way round.
  std::vector<std::vector<Eigen::Vector3i>> triangles;
};

// Runs Gmsh. `lengths` are those of TriangulateWithGmsh, m.
//
// Errors: FAILED_PRECONDITION, NO_GMSH, naming the package, where it is not on PATH; INTERNAL where
// Gmsh fails, takes longer than `limit`, or writes what cannot be read.
absl::StatusOr<GmshMesh> MeshWithGmsh(const std::vector<TopoDS_Face>& faces,
                                      const std::vector<double>& lengths,
                                      std::chrono::milliseconds limit = std::chrono::minutes(1));

}  // namespace mortise::cad
