#include "services/simulator/components.h"

#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/units.h"

namespace mortise::simulator {
namespace {

// Sets of nodes that elements connect.
class ConnectedNodes {
 public:
  explicit ConnectedNodes(const mesh::TetrahedralMesh& mesh) : parent_(mesh.nodes.cols()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
      for (Eigen::Index k = 1; k < mesh.tetrahedra.rows(); ++k) {
        parent_[Root(mesh.tetrahedra(k, e))] = Root(mesh.tetrahedra(0, e));
      }
    }
  }

  int Root(int node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace

std::vector<Component> FindComponents(const mesh::TetrahedralMesh& mesh) {
  ConnectedNodes connected(mesh);
  std::vector<int> index(mesh.nodes.cols(), -1);
  std::vector<Component> components;
  for (int v = 0; v < mesh.nodes.cols(); ++v) {
    int& component = index[connected.Root(v)];
    if (component < 0) {
      component = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[component].nodes.push_back(v);
  }
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    components[index[connected.Root(mesh.tetrahedra(0, e))]].parts.insert(mesh.part[e]);
  }
  return components;
}

std::string PlaceText(const Component& component, const mesh::TetrahedralMesh& mesh) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int v : component.nodes) middle += mesh.nodes.col(v) / component.nodes.size();
  middle /= kMillimetre;
  return absl::StrFormat("near (%.4g, %.4g, %.4g) mm", middle.x(), middle.y(), middle.z());
}

std::string PartsText(const Component& component, const mesh::TetrahedralMesh& mesh) {
  constexpr std::size_t kNamed = 4;
  std::vector<std::string> names;
  for (const int part : component.parts) {
    if (names.size() < kNamed) names.push_back(absl::StrCat("'", mesh.part_names[part], "'"));
  }
  const std::size_t more = component.parts.size() - names.size();
  const bool one = component.parts.size() == 1;
  return absl::StrCat(one ? "part " : "parts ", absl::StrJoin(names, ", "),
                      more > 0 ? absl::StrCat(" and ", more, " more") : "", one ? " is" : " are");
}

}  // namespace mortise::simulator
