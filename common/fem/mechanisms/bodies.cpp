#include "common/fem/mechanisms/bodies.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/units.h"
#include "common/mesh/element_faces.h"

namespace mortise::simulator {
namespace {

// Sets of elements that faces connect.
class ConnectedElements {
 public:
  explicit ConnectedElements(const mesh::TetrahedralMesh& mesh) : parent_(mesh.tetrahedra.cols()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    const std::vector<Face> faces = FacesByFirstCorner(mesh);
    for (std::size_t k = 1; k < faces.size(); ++k) {
      if (faces[k].corners == faces[k - 1].corners) {
        parent_[Root(faces[k].element)] = Root(faces[k - 1].element);
      }
    }
  }

  int Root(int element) {
    while (parent_[element] != element) {
      element = parent_[element] = parent_[parent_[element]];
    }
    return element;
  }

 private:
  struct Face {
    std::array<int, 3> corners;  // ascending
    int element;
  };

  // All faces of all elements, equal ones beside each other: sorted by their first corners by
  // counting, and then those of each.
  static std::vector<Face> FacesByFirstCorner(const mesh::TetrahedralMesh& mesh) {
    std::vector<int> starts(mesh.nodes.cols() + 1, 0);
    const auto visit = [&](const auto& see) {
      for (int e = 0; e < mesh.tetrahedra.cols(); ++e) {
        for (const auto& side : mesh::kTetrahedronFaces) {
          std::array<int, 3> corners{mesh.tetrahedra(side[0], e), mesh.tetrahedra(side[1], e),
                                     mesh.tetrahedra(side[2], e)};
          std::sort(corners.begin(), corners.end());
          see(Face{corners, e});
        }
      }
    };
    visit([&](const Face& face) { ++starts[face.corners[0] + 1]; });
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<Face> faces(starts.back());
    std::vector<int> next(starts.begin(), starts.end() - 1);
    visit([&](const Face& face) { faces[next[face.corners[0]]++] = face; });
    for (std::size_t v = 0; v + 1 < starts.size(); ++v) {
      std::sort(faces.begin() + starts[v], faces.begin() + starts[v + 1],
                [](const Face& a, const Face& b) {
                  return a.corners != b.corners ? a.corners < b.corners : a.element < b.element;
                });
    }
    return faces;
  }

  std::vector<int> parent_;
};

}  // namespace

std::vector<Body> FindBodies(const mesh::TetrahedralMesh& mesh) {
  ConnectedElements connected(mesh);
  const int elements = static_cast<int>(mesh.tetrahedra.cols());
  std::vector<int> number(elements, -1);
  std::vector<std::vector<int>> members;
  for (int e = 0; e < elements; ++e) {
    int& body = number[connected.Root(e)];
    if (body < 0) {
      body = static_cast<int>(members.size());
      members.emplace_back();
    }
    members[body].push_back(e);
  }
  std::vector<Body> bodies(members.size());
  std::vector<int> seen_in(mesh.nodes.cols(), -1);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (const int e : members[b]) {
      bodies[b].parts.insert(mesh.part[e]);
      for (const int v : mesh.tetrahedra.col(e)) {
        if (seen_in[v] == static_cast<int>(b)) continue;
        seen_in[v] = static_cast<int>(b);
        bodies[b].nodes.push_back(v);
      }
    }
    std::sort(bodies[b].nodes.begin(), bodies[b].nodes.end());
  }
  return bodies;
}

absl::Status CheckNodesAreUsed(const mesh::TetrahedralMesh& mesh) {
  std::vector<bool> used(mesh.nodes.cols(), false);
  for (const int v : mesh.tetrahedra.reshaped()) used[v] = true;
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused == used.end()) return absl::OkStatus();
  return InvalidField("nodes",
                      absl::StrCat("node ", unused - used.begin(), " belongs to no element"));
}

std::string PlaceText(const Body& body, const mesh::TetrahedralMesh& mesh) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int v : body.nodes) middle += mesh.nodes.col(v) / body.nodes.size();
  middle /= kMillimetre;
  return absl::StrFormat("near (%.4g, %.4g, %.4g) mm", middle.x(), middle.y(), middle.z());
}

std::string PartsText(const std::set<int>& parts, const mesh::TetrahedralMesh& mesh) {
  constexpr std::size_t kNamed = 4;
  std::vector<std::string> names;
  for (const int part : parts) {
    if (names.size() < kNamed) names.push_back(absl::StrCat("'", mesh.part_names[part], "'"));
  }
  const std::size_t more = parts.size() - names.size();
  const bool one = parts.size() == 1;
  return absl::StrCat(one ? "part " : "parts ", absl::StrJoin(names, ", "),
                      more > 0 ? absl::StrCat(" and ", more, " more") : "", one ? " is" : " are");
}

std::string BodyText(const Body& body, const std::vector<Body>& all,
                     const mesh::TetrahedralMesh& mesh) {
  const bool is_piece = std::any_of(all.begin(), all.end(), [&](const Body& other) {
    return &other != &body && std::any_of(body.parts.begin(), body.parts.end(),
                                          [&](int part) { return other.parts.count(part) != 0; });
  });
  return absl::StrCat(is_piece ? absl::StrCat("the piece ", PlaceText(body, mesh), " of ") : "",
                      PartsText(body.parts, mesh));
}

}  // namespace mortise::simulator
