#include "common/mesh/element_faces.h"

#include <algorithm>
#include <numeric>

namespace mortise::mesh {
namespace {

std::array<int, 3> Sorted(int a, int b, int c) {
  std::array<int, 3> key{a, b, c};
  std::sort(key.begin(), key.end());
  return key;
}

}  // namespace

ElementFaces::ElementFaces(const TetrahedralMesh& mesh) : mesh_(mesh) {
  // They are counted into place by their lowest corner, which few of them share, and only those are
  // compared: a quarter of the time that sorting all of them takes.
  const bool is_empty = mesh.tetrahedra.cols() == 0;
  const int nodes = is_empty ? 0 : mesh.tetrahedra.topRows(4).maxCoeff() + 1;
  std::vector<std::size_t> next(static_cast<std::size_t>(nodes) + 1, 0);
  const auto visit = [&mesh](const auto& add) {
    for (int e = 0; e < mesh.tetrahedra.cols(); ++e) {
      for (int side = 0; side < 4; ++side) {
        const auto& corner = kTetrahedronFaces[side];
        add({Sorted(mesh.tetrahedra(corner[0], e), mesh.tetrahedra(corner[1], e),
                    mesh.tetrahedra(corner[2], e)),
             e, side});
      }
    }
  };
  visit([&next](const ElementFace& face) { ++next[static_cast<std::size_t>(face.key[0]) + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  faces_.resize(next.back());
  visit([this, &next](const ElementFace& face) {
    faces_[next[static_cast<std::size_t>(face.key[0])]++] = face;
  });
  auto begin = faces_.begin();
  for (const std::size_t end : next) {
    const auto last = faces_.begin() + static_cast<std::ptrdiff_t>(end);
    std::sort(begin, last, [](const ElementFace& a, const ElementFace& b) {
      return a.key != b.key ? a.key < b.key : a.element < b.element;
    });
    begin = last;
  }
}

std::optional<Eigen::Vector3i> ElementFaces::FaceSeenFrom(const Eigen::Vector3i& corners,
                                                          int part) const {
  const auto key = Sorted(corners[0], corners[1], corners[2]);
  auto found = std::lower_bound(
      faces_.begin(), faces_.end(), key,
      [](const ElementFace& face, const std::array<int, 3>& wanted) { return face.key < wanted; });
  for (; found != faces_.end() && found->key == key; ++found) {
    if (mesh_.part[found->element] != part) continue;
    const auto& corner = kTetrahedronFaces[found->side];
    return Eigen::Vector3i(mesh_.tetrahedra(corner[0], found->element),
                           mesh_.tetrahedra(corner[1], found->element),
                           mesh_.tetrahedra(corner[2], found->element));
  }
  return std::nullopt;
}

std::vector<ElementFace> ElementFaces::Outer() const {
  std::vector<ElementFace> outer;
  for (std::size_t i = 0; i < faces_.size();) {
    std::size_t next = i + 1;
    while (next < faces_.size() && faces_[next].key == faces_[i].key) ++next;
    if (next - i == 1) outer.push_back(faces_[i]);
    i = next;
  }
  return outer;
}

}  // namespace mortise::mesh
