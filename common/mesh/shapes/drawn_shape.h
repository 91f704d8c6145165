// A drawn shape says what a part looks like in its box. It is a solid that is drawn once and
// stretched along the axes of its box with the box's size, so that every vertex is a linear
// function of a design's parameters (thesis §3.1). It is plain data: the CAD kernel reads and
// writes it in solid_shape.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/shapes/box_stretch.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

inline constexpr Eigen::Index kMaxShapeVertices = 50'000;
inline constexpr Eigen::Index kMaxShapeTriangles = 50'000;
// Distances, m as drawn: within kSameLevel two heights are one level, and within kOnPlane a vertex
// lies in a plane, such as a face of the box or a level. The second is what the CAD kernel leaves
// open where faces meet.
inline constexpr double kSameLevel = 1e-8;
inline constexpr double kOnPlane = 2e-7;

// A large planar face at a right angle to an axis, besides those in the faces of the box.
struct ShapePlane {
  std::string name;
  int axis = 0;         // 0, 1, 2: its normal is x, y, z
  double fraction = 0;  // of the box's size along the axis, from its middle; between -1/2 and 1/2
};

// Vertex k lies at center + size ∘ fractions.col(k) of whatever box the shape is in, if it is not
// stretched in pieces (box_stretch.h).
struct DrawnShape {
  std::string name;  // shapes/{digest}; empty as long as it is not stored
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  // m, of the box as drawn
  double volume = 0;              // m³ as drawn; exact where the triangles are not
  double deflection = 0;          // m as drawn, by which triangles may miss curved faces
  Eigen::Matrix3Xd fractions;     // 3 × V
  Eigen::Matrix3Xi triangles;     // 3 × T, counter-clockwise seen from outside
  Eigen::VectorXi triangle_face;  // T, index into face_names
  // The names of each face: first its own, then "x_min" … "z_max" if it lies in that face of the
  // box.
  std::vector<std::vector<std::string>> face_names;
  std::vector<ShapePlane> planes;
  // The volume that the solid of a divided shape (shape_levels.h) has beyond each triangle, T, m³
  // as drawn (missed_volume.h). It is empty if the shape is not divided.
  Eigen::VectorXd missed_volumes;
  // The kernel's exact solid with the lower corner of its box at the origin, before `turn`; empty
  // for what is only triangles.
  std::string brep;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  // False for what is only a surface (ShapeOfSurface): there is no solid to cut, bore or analyse.
  bool is_solid = true;
};

// Returns the shape with this closed surface. `minimum` and `maximum` are the corners of its box,
// m, which is larger than that of the triangles where curved faces bulge. `own_names` are those of
// each face, distinct. The volume is that of the triangles, and there is no deflection and no B-rep
// yet.
//
// INVALID_ARGUMENT, "shape", for open, not manifold, inside out or self-intersecting surfaces, with
// the places, for coordinates beyond 10 km, and for a box without size; RESOURCE_EXHAUSTED past
// kMaxShapeVertices or kMaxShapeTriangles.
absl::StatusOr<DrawnShape> MakeDrawnShape(const mesh::SurfaceMesh& surface,
                                          const Eigen::VectorXi& triangle_face,
                                          const std::vector<std::string>& own_names,
                                          const Eigen::Vector3d& minimum,
                                          const Eigen::Vector3d& maximum);

// Returns the shape of a mesh of which nothing else is known: its faces are those in the faces of
// its box, "face1" …, and all the rest, "surface". Fails as MakeDrawnShape does; INVALID_ARGUMENT,
// "shape", also for several solids, with the place where two meet in a vertex. The solid may have
// hollows.
absl::StatusOr<DrawnShape> ShapeOfMesh(const mesh::SurfaceMesh& surface);

// Returns the shape of a surface as people have it, in the box from `minimum` to `maximum`, m: that
// of ShapeOfMesh where it is the boundary of one solid, or would be if it were turned inside out.
// Otherwise it is only a surface (`is_solid` is false): open, flipped, doubled, crossing itself, of
// several pieces. Its volume is then what its triangles enclose about the middle of its box, at
// least a millionth of the box, which is an estimate where there are holes. It may be flat: then
// the box is as thick as the corners say. INVALID_ARGUMENT, "shape", for one without triangles, for
// coordinates beyond 10 km or not finite, and for a box without size; RESOURCE_EXHAUSTED as above.
absl::StatusOr<DrawnShape> ShapeOfSurface(SurfaceMesh surface, const Eigen::Vector3d& minimum,
                                          const Eigen::Vector3d& maximum);

// Returns how large a triangle is seen along an axis, as a share of the box's section across it.
double SectionOf(const DrawnShape& shape, Eigen::Index triangle, int axis);

// Fills in everything about `shape` that follows from its fractions, triangles, triangle_face and
// own names: names of faces in the faces of the box, and planes.
void DeriveFaces(DrawnShape& shape);

// Returns the surface stretched into a box whose middle is the origin, m. No triangle crosses a
// level of the stretch (DividedAt in shape_levels.h).
mesh::SurfaceMesh SurfaceIn(const DrawnShape& shape, const BoxStretch& stretch);

// Returns the volume in such a box, m³. Stretching in proportion multiplies volumes. Where the
// shape is stretched in pieces, the volume is that of the triangles and what they miss of it
// (missed_volume.h), as exact as `volume` where what is round keeps its size or is stretched in
// proportion. What is only a surface counts as stretched in proportion. O(T log L) for L levels, if
// the shape is divided.
double VolumeIn(const DrawnShape& shape, const BoxStretch& stretch);

// Returns by how much triangles may miss the exact surface in such a box, m. It is no more for bars
// and tubes that are longer, and no more for bores if the pieces that they lie in do not grow.
double DeflectionIn(const DrawnShape& shape, const BoxStretch& stretch);

// Returns the shape turned by whole right angles, forwards or backwards so that nothing is
// mirrored: its x and z axes become the axes `x_becomes` and `z_becomes`, and y follows.
DrawnShape Turned(const DrawnShape& shape, int x_becomes, int z_becomes);

}  // namespace mortise::mesh
