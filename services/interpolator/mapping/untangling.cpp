#include "services/interpolator/mapping/untangling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/mesh/element_faces.h"
#include "services/interpolator/mapping/volume_map.h"

namespace mortise::interpolator {
namespace {

constexpr int kPasses = 50;
constexpr int kHalvings = 20;

double SixVolumes(const Eigen::Matrix3Xd& nodes, const Eigen::Vector4i& element) {
  const Eigen::Vector3d a = nodes.col(element[0]);
  const Eigen::Vector3d b = nodes.col(element[1]) - a, c = nodes.col(element[2]) - a;
  return b.cross(c).dot(nodes.col(element[3]) - a);
}

// The share of its first volume that an element has is a linear function of where one node is.
struct LinearShare {
  Eigen::Vector3d gradient;
  double constant = 0;

  double At(const Eigen::Vector3d& place) const { return gradient.dot(place) + constant; }
};

class Untangler {
 public:
  Untangler(const mesh::TetrahedralMesh& mesh, const std::vector<bool>& is_free,
            Eigen::Matrix3Xd& nodes)
      : mesh_(mesh), is_free_(is_free), nodes_(nodes), around_(is_free.size()) {
    for (int e = 0; e < static_cast<int>(mesh.tetrahedra.cols()); ++e) {
      for (int k = 0; k < 4; ++k) {
        around_[static_cast<std::size_t>(mesh.tetrahedra(k, e))].push_back(e);
      }
    }
  }

  void Run() {
    for (int pass = 0; pass < kPasses; ++pass) {
      bool has_moved = false;
      for (const int element : InvertedElements(mesh_, nodes_)) {
        for (int k = 0; k < 4; ++k) {
          const int node = mesh_.tetrahedra(k, element);
          if (is_free_[static_cast<std::size_t>(node)]) has_moved = Improve(node) || has_moved;
        }
      }
      if (!has_moved) return;
    }
  }

 private:
  LinearShare ShareOf(int element, int node) const {
    const Eigen::Vector4i corners = mesh_.tetrahedra.col(element);
    int side = 0;
    while (corners[side] != node) ++side;
    const auto& face = mesh::kTetrahedronFaces[static_cast<std::size_t>(side)];
    const Eigen::Vector3d a = nodes_.col(corners[face[0]]), b = nodes_.col(corners[face[1]]);
    const Eigen::Vector3d c = nodes_.col(corners[face[2]]);
    // The face is outward, so that the volume grows against its normal.
    const Eigen::Vector3d inward = -(b - a).cross(c - a) / SixVolumes(mesh_.nodes, corners);
    return {inward, -inward.dot(a)};
  }

  // Climbs from where the node is towards the place where the least share is largest: along the
  // gradient of the least one, or the mean of those that are nearly as small.
  bool Improve(int node) {
    std::vector<LinearShare> shares;
    double reach = 0;
    for (const int element : around_[static_cast<std::size_t>(node)]) {
      shares.push_back(ShareOf(element, node));
      for (int k = 0; k < 4; ++k) {
        const int other = mesh_.tetrahedra(k, element);
        reach = std::max(reach, (nodes_.col(other) - nodes_.col(node)).norm());
      }
    }
    const auto least = [&shares](const Eigen::Vector3d& place) {
      double share = std::numeric_limits<double>::infinity();
      for (const LinearShare& of : shares) share = std::min(share, of.At(place));
      return share;
    };
    Eigen::Vector3d place = nodes_.col(node);
    double best = least(place);
    const double before = best;
    double step = reach;
    for (int halving = 0; halving < kHalvings;) {
      bool is_better = false;
      for (const double width : {0.0, 0.1, 0.5}) {
        Eigen::Vector3d direction = Eigen::Vector3d::Zero();
        for (const LinearShare& of : shares) {
          if (of.At(place) <= best + width * std::abs(best)) direction += of.gradient.normalized();
        }
        const Eigen::Vector3d next = place + step * direction.normalized();
        if (direction.norm() == 0 || least(next) <= best) continue;
        place = next;
        best = least(next);
        is_better = true;
        break;
      }
      if (is_better) continue;
      step /= 2;
      ++halving;
    }
    nodes_.col(node) = place;
    return best > before + 1e-6 * std::abs(before);
  }

  const mesh::TetrahedralMesh& mesh_;
  const std::vector<bool>& is_free_;
  Eigen::Matrix3Xd& nodes_;
  std::vector<std::vector<int>> around_;  // elements at each node
};

}  // namespace

void Untangle(const mesh::TetrahedralMesh& mesh, const std::vector<bool>& is_free,
              Eigen::Matrix3Xd& nodes) {
  Untangler(mesh, is_free, nodes).Run();
}

}  // namespace mortise::interpolator
