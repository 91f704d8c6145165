#include "common/mesh/shapes/drawn_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/shapes/missed_volume.h"
#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

constexpr double kMinSize = 1e-6;      // m
constexpr double kFurthest = 10e3;     // m, from the origin, as assemblies
constexpr double kSamePlane = 1e-9;    // of the size: fractions in one plane
constexpr double kAlong = 1e-6;        // of its largest section: that of a triangle along an axis
constexpr double kOneFactor = 1e-12;   // by how much factors of one enlargement may differ
constexpr double kProminent = 0.1;     // of the box's section: the least area of a large face
constexpr std::size_t kMaxPlanes = 4;  // along an axis
constexpr double kMinFilled = 1e-6;    // of its box: the volume of what is only a surface
constexpr int kMaxFaults = 5;          // told of one surface
constexpr int kMaxIntersections = 3;

const char* const kUnknownFace = "surface";  // of a mesh, but for what lies in its box's faces
const char* const kBoxFaces[3][2] = {{"x_min", "x_max"}, {"y_min", "y_max"}, {"z_min", "z_max"}};

std::string PlaceText(const Eigen::Vector3d& place) {
  return absl::StrFormat("(%.3f, %.3f, %.3f) mm", 1000 * place.x(), 1000 * place.y(),
                         1000 * place.z());
}

absl::Status CheckExtent(const mesh::SurfaceMesh& surface) {
  if (surface.triangles.cols() == 0) return InvalidField("shape", "has no triangles");
  if (surface.vertices.cols() > kMaxShapeVertices ||
      surface.triangles.cols() > kMaxShapeTriangles) {
    return TooLarge("shape", absl::StrCat(kMaxShapeVertices, " vertices and ", kMaxShapeTriangles,
                                          " triangles"));
  }
  if (!surface.vertices.allFinite()) {
    return InvalidField("shape", "has a coordinate that is not finite");
  }
  if (surface.vertices.cwiseAbs().maxCoeff() > kFurthest) {
    return InvalidField("shape",
                        absl::StrCat("lies further than ", kFurthest, " m from the origin"));
  }
  return absl::OkStatus();
}

absl::Status CheckSolid(const mesh::SurfaceMesh& surface) {
  MORTISE_RETURN_IF_ERROR(CheckExtent(surface));
  std::vector<FieldViolation> faults;
  for (const mesh::SurfaceFault& fault : mesh::CheckSurface(surface, kMaxFaults)) {
    faults.push_back({"shape", fault.message});
  }
  if (faults.empty()) {
    std::set<std::string> places;  // two pairs of triangles may cross in one
    for (const mesh::Intersection& crossing :
         mesh::FindIntersections(surface.vertices, surface.triangles, kMaxIntersections)) {
      const std::string place = PlaceText(crossing.place);
      if (!places.insert(place).second) continue;
      faults.push_back({"shape", absl::StrCat("the surface crosses itself at ", place)});
    }
  }
  return faults.empty() ? absl::OkStatus() : InvalidFields(faults);
}

// Refuses surfaces that enclose several solids, also where these meet in a vertex; a hollow, turned
// inwards, is none.
absl::Status CheckOneSolid(const mesh::SurfaceMesh& surface) {
  const CutSurface cut(surface.vertices, surface.triangles);
  const std::size_t corners = cut.origin().size();
  boost::disjoint_sets_with_storage<> pieces(corners);
  for (std::size_t corner = 0; corner < corners; ++corner) pieces.make_set(corner);
  std::map<std::size_t, double> volumes;  // six times m³
  const auto corner_of = [&](OpenMesh::HalfedgeHandle side) {
    return static_cast<std::size_t>(cut.mesh().from_vertex_handle(side).idx());
  };
  for (const auto side : cut.mesh().halfedges()) {
    pieces.union_set(corner_of(side), corner_of(cut.mesh().next_halfedge_handle(side)));
  }
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return surface.vertices.col(surface.triangles(k, t)) - surface.vertices.col(0);
    };
    const OpenMesh::HalfedgeHandle side = cut.mesh().halfedge_handle(OpenMesh::FaceHandle(t));
    volumes[pieces.find_set(corner_of(side))] += corner(0).dot(corner(1).cross(corner(2)));
  }
  const auto solids = std::count_if(volumes.begin(), volumes.end(),
                                    [](const auto& volume) { return volume.second > 0; });
  if (solids == 1) return absl::OkStatus();
  const auto vertices = static_cast<std::size_t>(surface.vertices.cols());
  for (std::size_t copy = vertices; copy < corners; ++copy) {
    const int origin = cut.origin()[copy];
    if (pieces.find_set(copy) == pieces.find_set(static_cast<std::size_t>(origin))) continue;
    return InvalidField("shape",
                        absl::StrCat("has ", solids, " solids that meet only in a vertex, at ",
                                     PlaceText(surface.vertices.col(origin))));
  }
  return InvalidField("shape", absl::StrCat("has ", solids, " separate solids, not one"));
}

// The face of the box along `axis` in which a triangle lies: 0, 1, or -1 for neither.
int SideOf(const DrawnShape& shape, Eigen::Index triangle, int axis) {
  const auto at = [&](int corner) {
    return shape.fractions(axis, shape.triangles(corner, triangle));
  };
  if (at(0) == at(1) && at(1) == at(2)) {
    if (at(0) == -0.5) return 0;
    if (at(0) == 0.5) return 1;
  }
  return -1;
}

// Whether a triangle runs along an axis, or ends there in a face of the box: what a curved face
// stands out from it is across the axis.
bool RunsAlong(const DrawnShape& shape, Eigen::Index triangle, int axis) {
  const double across = std::max(SectionOf(shape, triangle, (axis + 1) % 3),
                                 SectionOf(shape, triangle, (axis + 2) % 3));
  return SectionOf(shape, triangle, axis) <= kAlong * across || SideOf(shape, triangle, axis) >= 0;
}

// By how much a stretch lengthens, at most, what lies between two fractions along an axis.
double LargestFactor(const DrawnShape& shape, const BoxStretch& stretch, int axis, double low,
                     double high) {
  const double same = kOnPlane / shape.size[axis];
  const std::vector<LevelPlace> ends = stretch.Ends(axis);
  double factor = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const LevelPlace &below = ends[i], &above = ends[i + 1];
    if (below.fraction >= high - same || above.fraction <= low + same) continue;
    const double drawn = shape.size[axis] * (above.fraction - below.fraction);
    factor = std::max(factor, (above.place - below.place) / drawn);
  }
  return factor;
}

// The same of all triangles that do not run along the axis; 0 if all do. What lies flat in a level
// between two pieces is of neither.
double LargestFactorAcross(const DrawnShape& shape, const BoxStretch& stretch, int axis) {
  double factor = 0;
  for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
    if (RunsAlong(shape, t, axis)) continue;
    if (stretch.IsInProportion(axis)) return stretch.size[axis] / shape.size[axis];
    const auto height = [&](int k) { return shape.fractions(axis, shape.triangles(k, t)); };
    const auto [low, high] = std::minmax({height(0), height(1), height(2)});
    factor = std::max(factor, LargestFactor(shape, stretch, axis, low, high));
  }
  return factor;
}

void NameBoxFaces(DrawnShape& shape) {
  for (std::vector<std::string>& names : shape.face_names) names.resize(1);
  for (int axis = 0; axis < 3; ++axis) {
    // Of each face: -2 not seen, -1 not in a face of the box.
    std::vector<int> sides(shape.face_names.size(), -2);
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
      int& side = sides[static_cast<std::size_t>(shape.triangle_face(t))];
      const int here = SideOf(shape, t, axis);
      side = side == -2 || side == here ? here : -1;
    }
    for (std::size_t face = 0; face < sides.size(); ++face) {
      if (sides[face] >= 0) shape.face_names[face].push_back(kBoxFaces[axis][sides[face]]);
    }
  }
}

// Of each face, whether it is level along an axis as a whole: a strip of a curved one is no plane.
// Of what is only triangles, all that lies in no face of the box is one face, of which nothing can
// be told.
std::vector<bool> LevelFaces(const DrawnShape& shape, int axis) {
  std::vector<bool> is_level(shape.face_names.size(), true);
  for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
    const auto face = static_cast<std::size_t>(shape.triangle_face(t));
    if (shape.face_names[face].front() == kUnknownFace) continue;
    const auto height = [&](int k) { return shape.fractions(axis, shape.triangles(k, t)); };
    const auto [low, high] = std::minmax({height(0), height(1), height(2)});
    if (high - low > kSamePlane) is_level[face] = false;
  }
  return is_level;
}

void FindPlanes(DrawnShape& shape) {
  shape.planes.clear();
  const char* const letters = "xyz";
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<bool> is_level = LevelFaces(shape, axis);
    std::map<long long, std::pair<double, double>> areas;  // by rounded fraction: area, fraction
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
      if (!is_level[static_cast<std::size_t>(shape.triangle_face(t))]) continue;
      const Eigen::Vector3d along(shape.fractions(axis, shape.triangles(0, t)),
                                  shape.fractions(axis, shape.triangles(1, t)),
                                  shape.fractions(axis, shape.triangles(2, t)));
      if (along.maxCoeff() - along.minCoeff() > kSamePlane || std::abs(along[0]) >= 0.5) continue;
      auto& [area, fraction] = areas[std::llround(along[0] / (4 * kSamePlane))];
      area += SectionOf(shape, t, axis);
      fraction = along[0];
    }
    std::vector<std::pair<double, double>> large;
    for (const auto& [key, found] : areas) {
      if (found.first >= kProminent) large.push_back(found);
    }
    std::stable_sort(large.begin(), large.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    if (large.size() > kMaxPlanes) large.resize(kMaxPlanes);
    std::sort(large.begin(), large.end(),
              [](const auto& a, const auto& b) { return a.second < b.second; });
    for (std::size_t i = 0; i < large.size(); ++i) {
      shape.planes.push_back(
          {absl::StrCat(std::string(1, letters[axis]), " face ", i + 1), axis, large[i].second});
    }
  }
}

}  // namespace

double SectionOf(const DrawnShape& shape, Eigen::Index triangle, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto corner = [&](int k) { return shape.fractions.col(shape.triangles(k, triangle)); };
  const double au = corner(1)[u] - corner(0)[u], av = corner(1)[v] - corner(0)[v];
  const double bu = corner(2)[u] - corner(0)[u], bv = corner(2)[v] - corner(0)[v];
  return std::abs(au * bv - av * bu) / 2;
}

void DeriveFaces(DrawnShape& shape) {
  NameBoxFaces(shape);
  FindPlanes(shape);
}

namespace {

// Everything about a shape but its volume.
absl::StatusOr<DrawnShape> InBox(const mesh::SurfaceMesh& surface,
                                 const Eigen::VectorXi& triangle_face,
                                 const std::vector<std::string>& own_names,
                                 const Eigen::Vector3d& minimum, const Eigen::Vector3d& maximum) {
  DrawnShape shape;
  shape.size = maximum - minimum;
  if (!shape.size.allFinite() || shape.size.minCoeff() < kMinSize) {
    return InvalidField("shape", "has a side shorter than a micrometre");
  }
  const Eigen::Vector3d center = (minimum + maximum) / 2;
  shape.fractions = (surface.vertices.colwise() - center).array().colwise() / shape.size.array();
  for (Eigen::Index k = 0; k < shape.fractions.cols(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      double& fraction = shape.fractions(axis, k);
      if ((0.5 - std::abs(fraction)) * shape.size[axis] <= kOnPlane) {
        fraction = std::copysign(0.5, fraction);
      }
    }
  }
  shape.triangles = surface.triangles;
  shape.triangle_face = triangle_face;
  for (const std::string& name : own_names) shape.face_names.push_back({name});
  DeriveFaces(shape);
  return shape;
}

// What the triangles enclose, seen from the middle of the box, m³.
double EnclosedVolume(const DrawnShape& shape) {
  double six_fold = 0;
  for (const auto& triangle : shape.triangles.colwise()) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return shape.size.cwiseProduct(shape.fractions.col(triangle(k)));
    };
    six_fold += corner(0).dot(corner(1).cross(corner(2)));
  }
  return std::abs(six_fold) / 6;
}

}  // namespace

absl::StatusOr<DrawnShape> MakeDrawnShape(const mesh::SurfaceMesh& surface,
                                          const Eigen::VectorXi& triangle_face,
                                          const std::vector<std::string>& own_names,
                                          const Eigen::Vector3d& minimum,
                                          const Eigen::Vector3d& maximum) {
  MORTISE_RETURN_IF_ERROR(CheckSolid(surface));
  MORTISE_ASSIGN_OR_RETURN(DrawnShape shape,
                           InBox(surface, triangle_face, own_names, minimum, maximum));
  shape.volume = mesh::ComputeMassProperties(surface).volume;
  return shape;
}

absl::StatusOr<DrawnShape> ShapeOfMesh(const mesh::SurfaceMesh& surface) {
  if (surface.vertices.cols() == 0) return InvalidField("shape", "has no triangles");
  MORTISE_ASSIGN_OR_RETURN(
      DrawnShape shape,
      MakeDrawnShape(surface, Eigen::VectorXi::Zero(surface.triangles.cols()), {kUnknownFace},
                     surface.vertices.rowwise().minCoeff(), surface.vertices.rowwise().maxCoeff()));
  MORTISE_RETURN_IF_ERROR(CheckOneSolid(surface));
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const int face = static_cast<int>(shape.face_names.size());
      bool any = false;
      for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
        if (SideOf(shape, t, axis) != side) continue;
        shape.triangle_face(t) = face;
        any = true;
      }
      if (any) shape.face_names.push_back({absl::StrCat("face", face)});
    }
  }
  DeriveFaces(shape);
  return shape;
}

absl::StatusOr<DrawnShape> ShapeOfSurface(SurfaceMesh surface, const Eigen::Vector3d& minimum,
                                          const Eigen::Vector3d& maximum) {
  MORTISE_RETURN_IF_ERROR(CheckExtent(surface));
  if (ComputeMassProperties(surface).volume < 0) {
    surface.triangles.row(1).swap(surface.triangles.row(2));
  }
  absl::StatusOr<DrawnShape> solid = ShapeOfMesh(surface);
  if (solid.ok()) return solid;
  MORTISE_ASSIGN_OR_RETURN(DrawnShape shape,
                           InBox(surface, Eigen::VectorXi::Zero(surface.triangles.cols()),
                                 {kUnknownFace}, minimum, maximum));
  const double of_box = shape.size.prod();
  shape.volume = std::clamp(EnclosedVolume(shape), kMinFilled * of_box, of_box);
  shape.is_solid = false;
  return shape;
}

mesh::SurfaceMesh SurfaceIn(const DrawnShape& shape, const BoxStretch& stretch) {
  mesh::SurfaceMesh surface{stretch.size.asDiagonal() * shape.fractions, shape.triangles};
  for (int axis = 0; axis < 3; ++axis) {
    if (stretch.IsInProportion(axis)) continue;
    for (Eigen::Index k = 0; k < shape.fractions.cols(); ++k) {
      surface.vertices(axis, k) = stretch.PlaceOf(axis, shape.fractions(axis, k));
    }
  }
  return surface;
}

double VolumeIn(const DrawnShape& shape, const BoxStretch& stretch) {
  if (stretch.IsInProportion() || !shape.is_solid) {
    return shape.volume * (stretch.size.array() / shape.size.array()).prod();
  }
  return ComputeMassProperties(SurfaceIn(shape, stretch)).volume + MissedVolumeIn(shape, stretch);
}

double DeflectionIn(const DrawnShape& shape, const BoxStretch& stretch) {
  if (shape.deflection == 0) return 0;
  const Eigen::Vector3d factors = stretch.size.array() / shape.size.array();
  // As drawn, or as a whole larger or smaller, no triangle has to be looked at.
  const double rounding = kOneFactor * factors.maxCoeff();
  if (stretch.IsInProportion() && factors.maxCoeff() - factors.minCoeff() <= rounding) {
    return shape.deflection * factors.maxCoeff();
  }
  double grows = 0;
  for (int axis = 0; axis < 3; ++axis) {
    grows = std::max(grows, LargestFactorAcross(shape, stretch, axis));
  }
  return shape.deflection * (grows > 0 ? grows : factors.maxCoeff());
}

DrawnShape Turned(const DrawnShape& shape, int x_becomes, int z_becomes) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  turn.col(0) = Eigen::Vector3d::Unit(x_becomes);
  turn.col(2) = Eigen::Vector3d::Unit(z_becomes);
  turn.col(1) = turn.col(2).cross(turn.col(0));
  if (turn.isIdentity(0)) return shape;
  DrawnShape turned = shape;
  turned.size = turn.cwiseAbs() * shape.size;
  turned.fractions = turn * shape.fractions;
  turned.turn = turn * shape.turn;
  DeriveFaces(turned);
  return turned;
}

}  // namespace mortise::mesh
