// Triangulated surfaces of one part, and of a whole assembly whose touching parts share triangles.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace mortise::mesh {

// One closed, oriented triangle surface. Triangles are counter-clockwise seen from outside.
struct SurfaceMesh {
  Eigen::Matrix3Xd vertices;   // 3 × V, metres
  Eigen::Matrix3Xi triangles;  // 3 × T, columns of vertex indices
};

// A face of a part, as the template names it ("cap", "base", "side0" …).
struct NamedFace {
  int part = -1;     // index of the part in the assembly
  std::string name;  // name of the face on that part

  friend bool operator==(const NamedFace&, const NamedFace&) = default;
};

// One connected face of the fragmented assembly: a piece of one face of one part, or of two parts
// where they touch.
struct AssemblyFace {
  int front_part = -1;  // part on the side the triangles' normals point to; -1 is the outside
  int back_part = -1;   // part on the other side; -1 is the outside
  std::vector<NamedFace> origins;  // which faces of which parts it is a piece of (one or two)
};

// The points of the exact faces that stand behind those of a surface's triangles, which miss what
// is curved.
struct ExactPlaces {
  Eigen::Matrix3Xd vertices;  // 3 × V, metres
  Eigen::Matrix3Xd middles;   // 3 × 3T: of the sides 01, 12, 20 of each triangle in turn
};

// A conforming surface of an assembly: where two parts touch, one set of triangles serves both, and
// no triangle crosses another. It is the boundary that a tetrahedral mesher needs.
struct AssemblySurface {
  Eigen::Matrix3Xd vertices;      // 3 × V, metres
  Eigen::Matrix3Xi triangles;     // 3 × T
  Eigen::VectorXi triangle_face;  // T, index into `faces`
  std::vector<AssemblyFace> faces;
  Eigen::Matrix3Xd part_interior;         // 3 × P, a point strictly inside each part
  std::vector<std::string> part_names;    // P
  std::optional<ExactPlaces> exact = {};  // where it has curved faces that are known exactly
};

}  // namespace mortise::mesh
