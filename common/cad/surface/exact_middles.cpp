#include "common/cad/surface/exact_middles.h"

#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Poly_Triangulation.hxx>
#include <algorithm>
#include <array>
#include <optional>

#include "common/cad/occt_vectors.h"

namespace mortise::cad {
namespace {

constexpr int kMaxSteps = 20;
constexpr double kConverged = 1e-9;  // of a side's length
constexpr double kOnFace = 1e-2;     // of a side's length: how far what is found may be from a face
constexpr double kMaxWay = 0.25;     // of a side's length
// Singular value of two normals, below which their faces run into each other without a corner.
constexpr double kOneTangentPlane = 0.1;

// The point of a surface near which another is sought.
struct Foot {
  const BRepAdaptor_Surface* surface;
  gp_XY place;
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  // of length 1

  // Moves it towards the point of the surface nearest to `target`; false where there is no normal.
  bool Approach(const Eigen::Vector3d& target) {
    gp_Pnt at;
    gp_Vec along_u, along_v;
    surface->D1(place.X(), place.Y(), at, along_u, along_v);
    Eigen::Matrix<double, 3, 2> along;
    along << ToEigen(along_u.XYZ()), ToEigen(along_v.XYZ());
    const Eigen::Vector3d across = along.col(0).cross(along.col(1));
    if (!(across.norm() > 1e-9 * along.squaredNorm())) return false;
    const Eigen::Vector2d step =
        (along.transpose() * along).inverse() * (along.transpose() * (target - ToEigen(at.XYZ())));
    place += gp_XY(step.x(), step.y());
    surface->D1(place.X(), place.Y(), at, along_u, along_v);
    point = ToEigen(at.XYZ());
    normal = ToEigen(along_u.Crossed(along_v).XYZ());
    const double length = normal.norm();
    if (!(length > 0)) return false;
    normal /= length;
    return true;
  }
};

// The point nearest to `from` in the tangent planes of all feet.
Eigen::Vector3d InAllPlanes(const Eigen::Vector3d& from, const std::vector<Foot>& feet) {
  if (feet.size() == 1) {
    return from + feet[0].normal * feet[0].normal.dot(feet[0].point - from);
  }
  Eigen::MatrixX3d normals(static_cast<Eigen::Index>(feet.size()), 3);
  Eigen::VectorXd ways(normals.rows());
  for (Eigen::Index i = 0; i < ways.size(); ++i) {
    const Foot& foot = feet[static_cast<std::size_t>(i)];
    normals.row(i) = foot.normal.transpose();
    ways(i) = foot.normal.dot(foot.point - from);
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(normals, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::VectorXd step = svd.matrixU().transpose() * ways;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const double value = svd.singularValues()(i);
    step(i) = value < kOneTangentPlane ? 0 : step(i) / value;
  }
  return from + svd.matrixV() * step;
}

}  // namespace

ExactMiddles::Side ExactMiddles::SideOf(const mesh::AssemblySurface& surface, Eigen::Index triangle,
                                        int side) {
  return std::minmax<int>(surface.triangles(side, triangle),
                          surface.triangles((side + 1) % 3, triangle));
}

void ExactMiddles::Add(const TopoDS_Face& face, const std::vector<int>& points) {
  const int index = static_cast<int>(surfaces_.size());
  surfaces_.emplace_back(face, Standard_False);
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (!mesh->HasUVNodes()) return;
  for (int t = 1; t <= mesh->NbTriangles(); ++t) {
    std::array<int, 3> nodes{};
    mesh->Triangle(t).Get(nodes[0], nodes[1], nodes[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = nodes[k], to = nodes[(k + 1) % 3];
      const Side side(std::minmax(points[static_cast<std::size_t>(from)],
                                  points[static_cast<std::size_t>(to)]));
      places_[side].try_emplace(index, (mesh->UVNode(from).XY() + mesh->UVNode(to).XY()) / 2);
    }
  }
}

Eigen::Vector3d ExactMiddles::MiddleOf(const Side& side, const Eigen::Matrix3Xd& vertices) const {
  const Eigen::Vector3d halfway = (vertices.col(side.first) + vertices.col(side.second)) / 2;
  const double length = (vertices.col(side.second) - vertices.col(side.first)).norm();
  std::vector<Foot> feet;
  for (const auto& [face, place] : places_.at(side)) {
    feet.push_back(Foot{&surfaces_[static_cast<std::size_t>(face)], place, {}, {}});
  }
  Eigen::Vector3d found = halfway;
  for (int step = 0; step < kMaxSteps; ++step) {
    for (Foot& foot : feet) {
      if (!foot.Approach(found)) return halfway;
    }
    const Eigen::Vector3d before = found;
    found = InAllPlanes(halfway, feet);
    if ((found - before).norm() <= kConverged * length) break;
  }
  const double way = (found - halfway).norm();
  if (!(way <= kMaxWay * length)) return halfway;
  for (const Foot& foot : feet) {
    if (!((foot.point - found).norm() <= kOnFace * length)) return halfway;
  }
  return found;
}

bool ExactMiddles::IsPlane(int face) const {
  return surfaces_[static_cast<std::size_t>(face)].GetType() == GeomAbs_Plane;
}

std::map<ExactMiddles::Side, Eigen::Vector3d> ExactMiddles::MiddlesOffHalfway(
    const mesh::AssemblySurface& surface) const {
  std::map<Side, Eigen::Vector3d> middles;
  for (const auto& [side, faces] : places_) {
    const bool is_flat = std::all_of(faces.begin(), faces.end(),
                                     [this](const auto& known) { return IsPlane(known.first); });
    if (!is_flat) middles[side] = MiddleOf(side, surface.vertices);
  }
  // A side that another triangle does not have as it was drawn stays straight.
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto drawn = places_.find(SideOf(surface, t, k));
      if (drawn == places_.end() || drawn->second.contains(surface.triangle_face(t))) continue;
      middles.erase(drawn->first);
    }
  }
  return middles;
}

std::optional<mesh::ExactPlaces> ExactMiddles::Find(const mesh::AssemblySurface& surface) const {
  bool is_flat = true;
  for (std::size_t face = 0; face < surfaces_.size(); ++face) {
    is_flat = is_flat && IsPlane(static_cast<int>(face));
  }
  if (is_flat) return std::nullopt;
  const std::map<Side, Eigen::Vector3d> middles = MiddlesOffHalfway(surface);
  mesh::ExactPlaces places{surface.vertices, Eigen::Matrix3Xd(3, 3 * surface.triangles.cols())};
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Side side = SideOf(surface, t, k);
      const auto known = middles.find(side);
      places.middles.col(3 * t + k) =
          known != middles.end()
              ? known->second
              : Eigen::Vector3d(
                    (surface.vertices.col(side.first) + surface.vertices.col(side.second)) / 2);
    }
  }
  return places;
}

}  // namespace mortise::cad
