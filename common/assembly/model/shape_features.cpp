#include "common/assembly/model/shape_features.h"

#include <algorithm>
#include <cmath>

namespace mortise::parametric {
namespace {

constexpr double kRound = 1e-8;  // m, by which a cylinder may miss the sides of the box

template <typename Found, typename Find>
const Found& Look(std::map<const mesh::DrawnShape*, Found>& known, const mesh::DrawnShape& shape,
                  const Find& find) {
  const auto [found, is_new] = known.try_emplace(&shape);
  if (is_new) found->second = find();
  return found->second;
}

bool IsAsWideAsBox(const mesh::DrawnShape& shape, const mesh::RoundFace& face) {
  const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
  return !face.is_hollow && face.is_whole && std::abs(2 * face.radius - shape.size[a]) <= kRound &&
         std::abs(2 * face.radius - shape.size[b]) <= kRound;
}

bool LiesWithin(const mesh::DrawnShape& shape, const mesh::RoundFace& face) {
  const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
  const Eigen::ArrayXd x = shape.size[a] * shape.fractions.row(a).transpose().array();
  const Eigen::ArrayXd y = shape.size[b] * shape.fractions.row(b).transpose().array();
  return (x.square() + y.square()).sqrt().maxCoeff() <= face.radius + kRound;
}

}  // namespace

const std::vector<mesh::RoundFace>& ShapeFeatures::RoundFacesOf(const mesh::DrawnShape& shape) {
  return Look(round_faces_, shape, [&] { return mesh::RoundFacesOf(shape); });
}

const std::vector<mesh::Countersink>& ShapeFeatures::CountersinksOf(const mesh::DrawnShape& shape) {
  return Look(countersinks_, shape, [&] { return mesh::CountersinksOf(shape); });
}

const std::vector<mesh::Slot>& ShapeFeatures::SlotsOf(const mesh::DrawnShape& shape) {
  return Look(slots_, shape, [&] { return mesh::SlotsOf(RoundFacesOf(shape)); });
}

const std::vector<mesh::ShapeLevel>& ShapeFeatures::LevelsOf(const mesh::DrawnShape& shape) {
  return Look(levels_, shape, [&] { return mesh::LevelsOf(shape); });
}

std::optional<int> ShapeFeatures::RoundAboutOf(const mesh::DrawnShape& shape) {
  return Look(round_about_, shape, [&]() -> std::optional<int> {
    for (const mesh::RoundFace& face : RoundFacesOf(shape)) {
      if (IsAsWideAsBox(shape, face) && LiesWithin(shape, face)) return face.axis;
    }
    return std::nullopt;
  });
}

}  // namespace mortise::parametric
