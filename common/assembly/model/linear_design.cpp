#include "common/assembly/model/linear_design.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

BoundingBox BoxAround(const Eigen::Vector3d& center, const Eigen::Vector3d& size) {
  return {center - size / 2, center + size / 2};
}

std::string NameOf(const Assembly& assembly, const Element& element, int index) {
  if (index < static_cast<int>(element.parts.size())) {
    const int part = element.parts[static_cast<std::size_t>(index)];
    return assembly.parts[static_cast<std::size_t>(part)].name;
  }
  return absl::StrCat(element.name, " (", index + 1, ")");
}

}  // namespace

BoundingBox BoxOf(const Eigen::VectorXd& q, int element) {
  return BoxAround(q.segment<3>(CenterVariable(element, Axis::kX)),
                   q.segment<3>(SizeVariable(element, Axis::kX)));
}

absl::Status CheckPartCount(const Assembly& assembly, const std::vector<Element>& elements,
                            const Eigen::VectorXd& q) {
  const auto most = static_cast<std::int64_t>(kPartGrowthLimit * assembly.parts.size());
  std::int64_t count = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Element& element = elements[e];
    count +=
        element.pattern ? LayOut(*element.pattern, BoxOf(q, static_cast<int>(e))).part_count() : 1;
    if (count <= most) continue;
    return InvalidField(
        "q", absl::StrCat("'", element.name, "' is so large that the design would have ", count,
                          " parts; drawn with ", assembly.parts.size(), ", it may have ", most));
  }
  return absl::OkStatus();
}

std::vector<PlacedPart> PlaceParts(const Assembly& assembly, const std::vector<Element>& elements,
                                   const Eigen::VectorXd& q) {
  std::vector<PlacedPart> placed;
  placed.reserve(assembly.parts.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Element& element = elements[e];
    const int index = static_cast<int>(e);
    const BoundingBox box = BoxOf(q, index);
    if (!element.pattern) {
      placed.push_back(
          {NameOf(assembly, element, 0), index, box, StretchOf(elements, index, box, q)});
      continue;
    }
    const PatternLayout layout = LayOut(*element.pattern, box);
    for (int i = 0; i < layout.part_count(); ++i) {
      const BoundingBox part = BoxAround(layout.CenterOf(i), layout.part_size);
      placed.push_back(
          {NameOf(assembly, element, i), index, part, StretchOf(elements, index, part, q)});
    }
  }
  return placed;
}

mesh::SurfaceMesh SurfaceOf(const AssemblyPart& part) {
  return part.shape == nullptr ? SurfaceOf(part.box)
                               : SurfaceIn(*part.shape, part.box.center(), part.box.size());
}

mesh::BoxStretch StretchOf(const std::vector<Element>& elements, int element,
                           const BoundingBox& box, const Eigen::VectorXd& q) {
  mesh::BoxStretch stretch(box.size());
  for (int axis = 0; axis < 3; ++axis) {
    const auto& held =
        elements[static_cast<std::size_t>(element)].feature_anchors[static_cast<std::size_t>(axis)];
    if (held.empty()) continue;
    const double center = box.center()[axis];
    std::vector<mesh::LevelPlace> places;
    for (const FeatureAnchor& level : held) {
      places.push_back({level.fraction, level.place.At(q) - center});
    }
    double before = -stretch.size[axis] / 2;
    const bool in_order = std::all_of(places.begin(), places.end(), [&](const auto& level) {
      return level.place > std::exchange(before, level.place);
    });
    if (!in_order || before >= stretch.size[axis] / 2) continue;
    stretch.levels[static_cast<std::size_t>(axis)] = std::move(places);
  }
  return stretch;
}

mesh::SurfaceMesh SurfaceIn(const mesh::DrawnShape& shape, const Eigen::Vector3d& center,
                            const mesh::BoxStretch& stretch) {
  mesh::SurfaceMesh surface = mesh::SurfaceIn(shape, stretch);
  surface.vertices.colwise() += center;
  return surface;
}

mesh::SurfaceMesh SurfaceOf(const BoundingBox& box) {
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 8);
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = ((corner >> axis) & 1) != 0;
      surface.vertices(axis, corner) = upper ? box.maximum[axis] : box.minimum[axis];
    }
  }
  // Two triangles for each of the faces x-, x+, y-, y+, z-, z+.
  surface.triangles.resize(3, 12);
  surface.triangles << 0, 0, 1, 1, 0, 0, 2, 2, 0, 0, 4, 4,  //
      4, 6, 3, 7, 1, 5, 6, 7, 2, 3, 5, 7,                   //
      6, 2, 7, 5, 5, 4, 7, 3, 3, 1, 7, 6;
  return surface;
}

}  // namespace mortise::parametric
