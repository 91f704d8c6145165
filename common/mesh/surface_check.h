// Finds what keeps a triangle surface from being the boundary of a solid.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

struct SurfaceEdge;

// A fault of a surface at one place.
struct SurfaceFault {
  enum class Kind {
    kBadIndex,     // a triangle names a vertex that does not exist
    kNotFinite,    // a coordinate is NaN or infinite
    kDegenerate,   // a triangle has no area
    kOpenEdge,     // an edge belongs to one triangle only
    kFlippedEdge,  // two triangles run along an edge in the same direction
    kOvercrowded,  // more than two triangles meet at an edge
    kPinched,      // triangles around a vertex that share no edges with the others there
    kInsideOut,    // closed, but the enclosed volume is not positive
  };
  Kind kind = Kind::kOpenEdge;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, the middle of the edge or triangle
  std::string message;                              // for people, with the place in millimetres
};

// Returns all faults of a surface, at most `limit`; empty for a closed, oriented 2-manifold of
// positive volume, which may meet itself in single vertices. (Self-intersections are searched by
// FindIntersections.)
std::vector<SurfaceFault> CheckSurface(const SurfaceMesh& surface, int limit = 20);

// Returns the first fault of indices and coordinates, on which all else relies; empty if there is
// none.
std::vector<SurfaceFault> CheckNumbers(const Eigen::Matrix3Xd& vertices,
                                       const Eigen::Matrix3Xi& triangles);

// Returns what is wrong at an edge; nothing if two triangles run along it, once either way.
std::optional<SurfaceFault> FaultAt(const SurfaceEdge& edge, const Eigen::Matrix3Xd& vertices);

// Makes a fault whose message has its place: "what at (1, 2, 3) mm".
SurfaceFault FaultAt(SurfaceFault::Kind kind, const Eigen::Vector3d& place,
                     const std::string& what);

// Whether a triangle has no area, but for rounding.
bool IsDegenerate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// Whether every edge has as many triangles that run along it one way as the other. It has, too, in
// solids that touch themselves along an edge.
bool IsBalanced(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles);

// Whether CheckSurface finds nothing.
bool IsWatertight(const SurfaceMesh& surface);

// Two triangles that cross or overlap although they are not neighbours.
struct Intersection {
  int first = -1;
  int second = -1;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, a point of both
};

// Returns pairs of triangles that meet anywhere but in a shared vertex or edge, at most `limit`. It
// works on vertices and triangles of any surface, so also on a whole assembly, by a sweep over
// bounding boxes: about O(T log T) for ordinary surfaces.
std::vector<Intersection> FindIntersections(const Eigen::Matrix3Xd& vertices,
                                            const Eigen::Matrix3Xi& triangles, int limit = 1);

// Returns the closed surface of one part of an assembly with its normals outward, and only the
// vertices that it uses.
SurfaceMesh PartSurface(const AssemblySurface& assembly, int part);

// Checks that `assembly` can be meshed: sizes agree, every part is watertight and its interior
// point lies inside it and in no other part. INVALID_ARGUMENT with the field ("parts[2]",
// "triangles") and, in words, the part and the place of the first fault.
absl::Status CheckAssembly(const AssemblySurface& assembly);

// Returns how often the surface winds round `point`: 1 inside, 0 outside of a closed oriented
// surface (generalised winding number: the sum of signed solid angles over 4π).
double WindingNumber(const SurfaceMesh& surface, const Eigen::Vector3d& point);

}  // namespace mortise::mesh
