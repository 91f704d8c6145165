#include "common/mesh/face_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/mesh/edge_sampling.h"

namespace mortise::mesh {
namespace {

constexpr double kInPlane = 0.8;    // cosine to the normal of a loop, of axes that lie in its plane
constexpr double kEncloses = 1e-3;  // of the square of its length, what a loop encloses at least
constexpr const char* kNoName = "?";  // of an end of an edge

// A side of a triangle between two faces, with the lower face on its left.
struct Side {
  int from = -1, to = -1;     // vertices
  int left = -1, right = -1;  // faces
};

// Sides one after another; vertices are one more, the first again at the end of a closed edge.
struct Chain {
  std::vector<int> vertices;
  int left = -1, right = -1;
  bool is_closed = false;  // and no vertex of it has a name
};

class FaceEdges {
 public:
  explicit FaceEdges(const FacedSurface& surface)
      : surface_(surface),
        is_open_(static_cast<std::size_t>(surface.vertices.cols()), false),
        sides_of_(static_cast<std::size_t>(surface.vertices.cols())) {
    SortFaces();
    CollectSides();
    NameCorners();
    FollowSides();
  }

  absl::StatusOr<ControlVariables> Sample(double spacing) {
    ControlVariables variables;
    std::map<std::string, std::vector<int>> by_name;
    for (const auto& [vertex, name] : corners_) {
      if (name != kNoName) by_name[name].push_back(vertex);
    }
    std::map<int, int> point_of;
    for (const auto& [name, vertices] : by_name) {
      if (vertices.size() > 1) continue;
      point_of[vertices[0]] = static_cast<int>(variables.points.size());
      variables.points.push_back({name, surface_.vertices.col(vertices[0]), vertices[0]});
    }
    std::map<std::string, std::vector<const Chain*>> edges;
    for (const Chain& chain : chains_) edges[NameOf(chain)].push_back(&chain);
    const auto point = [&](int vertex) {
      const auto found = point_of.find(vertex);
      return found == point_of.end() ? -1 : found->second;
    };
    for (const auto& [name, chains] : edges) {
      if (chains.size() > 1) continue;
      const Chain& chain = *chains[0];
      NamedEdge edge;
      edge.name = name;
      edge.is_closed = chain.vertices.front() == chain.vertices.back();
      edge.from = point(chain.vertices.front());
      edge.to = point(chain.vertices.back());
      Eigen::Matrix3Xd places = surface_.vertices(Eigen::all, chain.vertices);
      if (chain.is_closed && !BeginAlongAxis(places, edge.name)) continue;
      edge.way = WayAlong(places, edge.length);
      MORTISE_RETURN_IF_ERROR(SampleEdge(edge, spacing, variables));
    }
    return variables;
  }

 private:
  // Numbers the faces by their names.
  void SortFaces() {
    names_ = surface_.face_names;
    std::sort(names_.begin(), names_.end());
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    std::vector<int> number;
    for (const std::string& name : surface_.face_names) {
      number.push_back(
          static_cast<int>(std::lower_bound(names_.begin(), names_.end(), name) - names_.begin()));
    }
    for (const int face : surface_.triangle_face) {
      face_.push_back(number[static_cast<std::size_t>(face)]);
    }
  }

  // Takes the sides between different faces, and marks vertices of sides that are not between two
  // triangles which go on from each other.
  void CollectSides() {
    std::vector<std::tuple<int, int, int, bool>> all;  // low, high, triangle, from low to high
    all.reserve(static_cast<std::size_t>(3 * surface_.triangles.cols()));
    for (int t = 0; t < surface_.triangles.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const int from = surface_.triangles(k, t), to = surface_.triangles((k + 1) % 3, t);
        all.emplace_back(std::min(from, to), std::max(from, to), t, from < to);
      }
    }
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
      const auto [low, high, first, ascends] = all[i];
      while (end < all.size() && std::get<0>(all[end]) == low && std::get<1>(all[end]) == high) {
        ++end;
      }
      if (end - i != 2 || std::get<3>(all[i + 1]) == ascends) {
        is_open_[static_cast<std::size_t>(low)] = is_open_[static_cast<std::size_t>(high)] = true;
        continue;
      }
      const int a = face_[static_cast<std::size_t>(first)];
      const int b = face_[static_cast<std::size_t>(std::get<2>(all[i + 1]))];
      if (a == b) continue;
      // The triangle that has the side from low to high lies on its left.
      const bool is_forward = ascends == (a < b);
      const int side = static_cast<int>(sides_.size());
      sides_.push_back(
          {is_forward ? low : high, is_forward ? high : low, std::min(a, b), std::max(a, b)});
      sides_of_[static_cast<std::size_t>(low)].push_back(side);
      sides_of_[static_cast<std::size_t>(high)].push_back(side);
    }
  }

  bool IsCorner(int vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return !sides_of_[v].empty() && (is_open_[v] || sides_of_[v].size() != 2);
  }

  void NameCorners() {
    std::map<int, std::vector<int>> triangles_at;
    for (int v = 0; v < surface_.vertices.cols(); ++v) {
      if (IsCorner(v)) triangles_at[v];
    }
    for (int t = 0; t < surface_.triangles.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const auto corner = triangles_at.find(surface_.triangles(k, t));
        if (corner != triangles_at.end()) corner->second.push_back(t);
      }
    }
    for (const auto& [vertex, triangles] : triangles_at) {
      corners_[vertex] = NameOfCorner(vertex, triangles);
    }
  }

  // The faces around it in order; none unless its triangles are one closed fan.
  std::string NameOfCorner(int vertex, const std::vector<int>& triangles) const {
    if (is_open_[static_cast<std::size_t>(vertex)]) return kNoName;
    std::map<int, std::pair<int, int>> fan;  // by the vertex after it: the one before it, the face
    for (const int t : triangles) {
      int k = 0;
      while (surface_.triangles(k, t) != vertex) ++k;
      fan[surface_.triangles((k + 1) % 3, t)] = {surface_.triangles((k + 2) % 3, t),
                                                 face_[static_cast<std::size_t>(t)]};
    }
    std::vector<int> around;
    std::size_t seen = 0;
    const int first = fan.begin()->first;
    int at = first;
    do {
      const auto next = fan.find(at);
      if (next == fan.end()) return kNoName;
      if (around.empty() || around.back() != next->second.second) {
        around.push_back(next->second.second);
      }
      at = next->second.first;
      ++seen;
    } while (at != first && seen <= fan.size());
    if (seen != triangles.size()) return kNoName;
    if (around.size() > 1 && around.front() == around.back()) around.pop_back();
    return Around(around);
  }

  // Of all places to begin at, the one that gives the lowest order.
  std::string Around(const std::vector<int>& faces) const {
    std::vector<int> lowest = faces, turned = faces;
    for (std::size_t i = 1; i < faces.size(); ++i) {
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      lowest = std::min(lowest, turned);
    }
    return absl::StrJoin(lowest, " | ", [this](std::string* out, int face) {
      out->append(names_[static_cast<std::size_t>(face)]);
    });
  }

  void FollowSides() {
    is_followed_.assign(sides_.size(), false);
    for (const auto& [vertex, name] : corners_) {
      for (const int side : sides_of_[static_cast<std::size_t>(vertex)]) {
        if (sides_[static_cast<std::size_t>(side)].from == vertex) Follow(side);
      }
    }
    // What is left goes round.
    for (int side = 0; side < static_cast<int>(sides_.size()); ++side) {
      if (!is_followed_[static_cast<std::size_t>(side)]) Follow(side);
    }
  }

  void Follow(int side) {
    Chain chain;
    chain.left = sides_[static_cast<std::size_t>(side)].left;
    chain.right = sides_[static_cast<std::size_t>(side)].right;
    chain.vertices.push_back(sides_[static_cast<std::size_t>(side)].from);
    while (side >= 0 && !is_followed_[static_cast<std::size_t>(side)]) {
      is_followed_[static_cast<std::size_t>(side)] = true;
      const int to = sides_[static_cast<std::size_t>(side)].to;
      chain.vertices.push_back(to);
      side = IsCorner(to) ? -1 : NextFrom(to);
    }
    chain.is_closed =
        chain.vertices.front() == chain.vertices.back() && !IsCorner(chain.vertices.front());
    chains_.push_back(std::move(chain));
  }

  int NextFrom(int vertex) const {
    for (const int side : sides_of_[static_cast<std::size_t>(vertex)]) {
      if (sides_[static_cast<std::size_t>(side)].from == vertex) return side;
    }
    return -1;
  }

  std::string NameOf(const Chain& chain) const {
    const std::string faces = absl::StrCat(names_[static_cast<std::size_t>(chain.left)], " & ",
                                           names_[static_cast<std::size_t>(chain.right)]);
    if (chain.is_closed) return absl::StrCat(faces, " around");
    return absl::StrCat(faces, " from ", corners_.at(chain.vertices.front()), " to ",
                        corners_.at(chain.vertices.back()));
  }

  // Turns a closed way so that it begins where it crosses the half plane that FindControlVariables
  // tells of, and adds the axis to its name. False if there is no such place, or several.
  static bool BeginAlongAxis(Eigen::Matrix3Xd& places, std::string& name) {
    const Eigen::Index count = places.cols() - 1;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
    double length = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d a = places.col(i), b = places.col(i + 1);
      normal += (a - places.col(0)).cross(b - places.col(0)) / 2;
      centre += (b - a).norm() * (a + b) / 2;
      length += (b - a).norm();
    }
    if (!(normal.norm() > kEncloses * length * length)) return false;
    normal.normalize();
    centre /= length;
    int axis = 0;
    while (axis < 2 && std::abs(normal[axis]) > kInPlane) ++axis;
    const Eigen::Vector3d across = normal.cross(Eigen::Vector3d::Unit(axis)).normalized();
    const Eigen::Vector3d along = across.cross(normal);
    Eigen::Index crossed = -1;
    double share = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d a = places.col(i) - centre, b = places.col(i + 1) - centre;
      const double before = across.dot(a), after = across.dot(b);
      if ((before < 0) == (after < 0)) continue;
      const double at = before / (before - after);
      if (along.dot((1 - at) * a + at * b) <= 0) continue;
      if (crossed >= 0) return false;
      crossed = i;
      share = at;
    }
    if (crossed < 0) return false;
    const Eigen::Vector3d begin =
        (1 - share) * places.col(crossed) + share * places.col(crossed + 1);
    Eigen::Matrix3Xd turned(3, count + 2);
    turned.col(0) = turned.col(count + 1) = begin;
    for (Eigen::Index i = 0; i < count; ++i)
      turned.col(i + 1) = places.col((crossed + 1 + i) % count);
    places = std::move(turned);
    absl::StrAppend(&name, " from ", std::string(1, "xyz"[axis]));
    return true;
  }

  const FacedSurface& surface_;
  std::vector<std::string> names_;          // of faces, ascending
  std::vector<int> face_;                   // of each triangle, index into `names_`
  std::vector<bool> is_open_;               // of each vertex
  std::vector<std::vector<int>> sides_of_;  // of each vertex
  std::vector<Side> sides_;
  std::vector<bool> is_followed_;       // of each side
  std::map<int, std::string> corners_;  // names, by vertex
  std::vector<Chain> chains_;
};

std::string NameOf(const AssemblyFace& face, const std::vector<std::string>& part_names) {
  std::set<std::string> names;
  for (const NamedFace& origin : face.origins) {
    names.insert(
        part_names.size() == 1
            ? origin.name
            : absl::StrCat(part_names[static_cast<std::size_t>(origin.part)], "/", origin.name));
  }
  return absl::StrJoin(names, " = ");
}

}  // namespace

FacedSurface OuterFaces(const Eigen::Matrix3Xd& vertices, const Eigen::MatrixXi& triangles,
                        const Eigen::VectorXi& triangle_face,
                        const std::vector<AssemblyFace>& faces,
                        const std::vector<std::string>& part_names) {
  FacedSurface outer{vertices, Eigen::Matrix3Xi(3, triangles.cols()), {}, {}};
  for (const AssemblyFace& face : faces) outer.face_names.push_back(NameOf(face, part_names));
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const AssemblyFace& face = faces[static_cast<std::size_t>(triangle_face[t])];
    if ((face.front_part < 0) == (face.back_part < 0)) continue;
    outer.triangles.col(count) = triangles.col(t).head<3>();
    if (face.back_part < 0) std::swap(outer.triangles(1, count), outer.triangles(2, count));
    ++count;
    outer.triangle_face.push_back(triangle_face[t]);
  }
  outer.triangles.conservativeResize(3, count);
  return outer;
}

absl::StatusOr<ControlVariables> FindControlVariables(const FacedSurface& surface, double spacing) {
  if (!std::isfinite(spacing) || spacing <= 0) {
    return InvalidField("spacing", absl::StrCat("is ", spacing, " m, not positive"));
  }
  return FaceEdges(surface).Sample(spacing);
}

}  // namespace mortise::mesh
