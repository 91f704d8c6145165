#include "common/mesh/surface_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/mass_properties.h"

namespace mortise::mesh {

using Kind = SurfaceFault::Kind;

SurfaceFault FaultAt(Kind kind, const Eigen::Vector3d& place, const std::string& what) {
  return {kind, place,
          absl::StrCat(what, absl::StrFormat(" at (%.4g, %.4g, %.4g) mm", 1e3 * place.x(),
                                             1e3 * place.y(), 1e3 * place.z()))};
}

std::vector<SurfaceFault> CheckNumbers(const Eigen::Matrix3Xd& vertices,
                                       const Eigen::Matrix3Xi& triangles) {
  const Eigen::Vector3d nowhere = Eigen::Vector3d::Zero();
  if (triangles.cols() == 0) return {{Kind::kOpenEdge, nowhere, "the surface has no triangles"}};
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    if (triangles.col(t).minCoeff() < 0 || triangles.col(t).maxCoeff() >= vertices.cols()) {
      return {{Kind::kBadIndex, nowhere,
               absl::StrCat("triangle ", t, " names a vertex that does not exist")}};
    }
  }
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    if (!vertices.col(v).allFinite()) {
      return {{Kind::kNotFinite, nowhere, absl::StrCat("vertex ", v, " is not finite")}};
    }
  }
  return {};
}

std::optional<SurfaceFault> FaultAt(const SurfaceEdge& edge, const Eigen::Matrix3Xd& vertices) {
  if (edge.IsJoined()) return std::nullopt;
  const Eigen::Vector3d middle = 0.5 * (vertices.col(edge.low) + vertices.col(edge.high));
  if (edge.triangles() == 1) {
    return FaultAt(Kind::kOpenEdge, middle, "the surface is open along an edge");
  }
  if (edge.triangles() > 2) {
    return FaultAt(Kind::kOvercrowded, middle, "more than two triangles meet at an edge");
  }
  return FaultAt(Kind::kFlippedEdge, middle, "two neighbouring triangles face opposite ways");
}

bool IsDegenerate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double longest2 =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() <= 1e-12 * longest2;
}

std::vector<SurfaceFault> CheckSurface(const SurfaceMesh& surface, int limit) {
  const auto& [vertices, triangles] = surface;
  std::vector<SurfaceFault> faults = CheckNumbers(vertices, triangles);
  if (!faults.empty()) return faults;
  const auto full = [&] { return static_cast<int>(faults.size()) >= limit; };
  for (Eigen::Index t = 0; t < triangles.cols() && !full(); ++t) {
    const Eigen::Vector3d a = vertices.col(triangles(0, t)), b = vertices.col(triangles(1, t)),
                          c = vertices.col(triangles(2, t));
    if (IsDegenerate(a, b, c)) {
      faults.push_back(FaultAt(Kind::kDegenerate, (a + b + c) / 3, "a triangle has no area"));
    }
  }
  if (full()) return faults;
  const CutSurface cut(vertices, triangles);
  for (const SurfaceEdge& edge : cut.edges()) {
    if (full()) break;
    if (auto fault = FaultAt(edge, vertices)) faults.push_back(*std::move(fault));
  }
  if (faults.empty()) {
    const MassProperties mass = ComputeMassProperties(surface);
    if (!(mass.volume > 0)) {
      faults.push_back(FaultAt(Kind::kInsideOut, vertices.rowwise().mean(),
                               "the surface is inside out or encloses nothing,"));
    }
  }
  return faults;
}

bool IsBalanced(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  const CutSurface cut(vertices, triangles);
  return std::all_of(cut.edges().begin(), cut.edges().end(),
                     [](const SurfaceEdge& edge) { return edge.forward == edge.backward; });
}

bool IsWatertight(const SurfaceMesh& surface) { return CheckSurface(surface, 1).empty(); }

SurfaceMesh PartSurface(const AssemblySurface& assembly, int part) {
  std::vector<Eigen::Vector3i> triangles;
  for (Eigen::Index t = 0; t < assembly.triangles.cols(); ++t) {
    const AssemblyFace& face = assembly.faces[assembly.triangle_face[t]];
    if (face.front_part == face.back_part) continue;
    Eigen::Vector3i triangle = assembly.triangles.col(t);
    if (face.back_part == part) {
      triangles.push_back(triangle);
    } else if (face.front_part == part) {
      std::swap(triangle[1], triangle[2]);
      triangles.push_back(triangle);
    }
  }
  std::vector<int> index(assembly.vertices.cols(), -1);
  std::vector<int> used;
  SurfaceMesh surface;
  surface.triangles.resize(3, triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      int& mapped = index[triangles[t][k]];
      if (mapped < 0) {
        mapped = static_cast<int>(used.size());
        used.push_back(triangles[t][k]);
      }
      surface.triangles(k, t) = mapped;
    }
  }
  surface.vertices.resize(3, used.size());
  for (std::size_t v = 0; v < used.size(); ++v) {
    surface.vertices.col(v) = assembly.vertices.col(used[v]);
  }
  return surface;
}

double WindingNumber(const SurfaceMesh& surface, const Eigen::Vector3d& point) {
  double angle = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t)) - point;
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t)) - point;
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t)) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    // Van Oosterom and Strackee's formula for the solid angle of a triangle.
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

absl::Status CheckAssembly(const AssemblySurface& assembly) {
  const int parts = static_cast<int>(assembly.part_names.size());
  const int faces = static_cast<int>(assembly.faces.size());
  if (parts == 0) return InvalidField("part_names", "an assembly needs at least one part");
  if (assembly.part_interior.cols() != parts || !assembly.part_interior.allFinite()) {
    return InvalidField("part_interior", "must be one finite point for each part");
  }
  if (assembly.triangle_face.size() != assembly.triangles.cols()) {
    return InvalidField("triangle_face", "must be one face index for each triangle");
  }
  const auto numbers = CheckNumbers(assembly.vertices, assembly.triangles);
  if (!numbers.empty()) return InvalidField("triangles", numbers[0].message);
  for (Eigen::Index t = 0; t < assembly.triangle_face.size(); ++t) {
    if (assembly.triangle_face[t] < 0 || assembly.triangle_face[t] >= faces) {
      return InvalidField("triangle_face", absl::StrCat("triangle ", t, " has no face"));
    }
  }
  for (int f = 0; f < faces; ++f) {
    const AssemblyFace& face = assembly.faces[f];
    if (face.front_part < -1 || face.front_part >= parts || face.back_part < -1 ||
        face.back_part >= parts) {
      return InvalidField(absl::StrCat("faces[", f, "]"), "names a part that does not exist");
    }
  }
  std::vector<SurfaceMesh> surfaces;
  for (int p = 0; p < parts; ++p) {
    surfaces.push_back(PartSurface(assembly, p));
    const auto faults = CheckSurface(surfaces.back(), 1);
    if (!faults.empty()) {
      return InvalidField(
          absl::StrCat("parts[", p, "]"),
          absl::StrCat("part '", assembly.part_names[p], "' is not a solid: ", faults[0].message));
    }
  }
  for (int p = 0; p < parts; ++p) {
    for (int other = 0; other < parts; ++other) {
      const double winding = WindingNumber(surfaces[other], assembly.part_interior.col(p));
      if (std::abs(winding - (other == p ? 1 : 0)) < 0.5) continue;
      return InvalidField(absl::StrCat("part_interior[", p, "]"),
                          absl::StrCat("the interior point of part '", assembly.part_names[p],
                                       "' lies ", other == p ? "outside it" : "in part '",
                                       other == p ? "" : assembly.part_names[other] + "'"));
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::mesh
