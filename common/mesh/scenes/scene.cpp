#include "common/mesh/scenes/scene.h"

#include <array>
#include <utility>

#include "absl/strings/str_format.h"
#include "common/mesh/joined_surface.h"

namespace mortise::mesh {
namespace {

struct UnitRange {
  double low;  // of the diagonal, in the scene's unit
  double high;
  double unit;  // m
  const char* name;
};
constexpr std::array<UnitRange, 3> kUnitRanges = {
    {{0.1, 20, 1, "metres"}, {20, 300, 0.01, "centimetres"}, {300, 20'000, 0.001, "millimetres"}}};

Eigen::Matrix3d TurnToZ(UpAxis up) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (up == UpAxis::kY) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  if (up == UpAxis::kX) turn << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  return turn;
}

}  // namespace

UpAxis UpAxisOf(int number) {
  return number >= 1 && number <= 3 ? static_cast<UpAxis>(number) : UpAxis::kUnknown;
}

std::int64_t TriangleCount(const Scene& scene) {
  std::int64_t count = 0;
  for (const SceneComponent& component : scene.components) count += component.triangles.cols();
  return count;
}

Eigen::AlignedBox3d BoxOf(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const SceneComponent& component : scene.components) {
    for (const int vertex : component.triangles.reshaped()) {
      box.extend(component.vertices.col(vertex));
    }
  }
  return box;
}

SceneComponent Joined(const Scene& scene) {
  std::vector<SurfaceView> views;
  views.reserve(scene.components.size());
  for (const SceneComponent& component : scene.components) views.push_back(ViewOf(component));
  SurfaceMesh joined = Joined(views);
  return {"", std::move(joined.vertices), std::move(joined.triangles)};
}

Scene Scaled(Scene scene, double unit) {
  for (SceneComponent& component : scene.components) component.vertices *= unit;
  scene.unit = 1;
  return scene;
}

Scene TurnedUpright(Scene scene, UpAxis up) {
  if (up == UpAxis::kUnknown) return scene;
  const Eigen::Matrix3d turn = TurnToZ(up);
  for (SceneComponent& component : scene.components) {
    component.vertices = (turn * component.vertices).eval();
  }
  scene.up = UpAxis::kZ;
  return scene;
}

std::optional<UnitGuess> GuessUnit(const Scene& scene) {
  const Eigen::AlignedBox3d box = BoxOf(scene);
  if (box.isEmpty()) return std::nullopt;
  const double diagonal = box.diagonal().norm();
  for (const UnitRange& range : kUnitRanges) {
    if (diagonal < range.low || diagonal >= range.high) continue;
    return UnitGuess{
        range.unit, absl::StrFormat("The unit is a guess: %s, as the surface measures %.3g across.",
                                    range.name, diagonal)};
  }
  return std::nullopt;
}

Scene Settled(Scene scene, UpAxis up, std::optional<double> unit) {
  if (up == UpAxis::kUnknown) up = scene.up;
  if (up != UpAxis::kUnknown) scene = TurnedUpright(std::move(scene), up);
  if (!unit) unit = scene.unit;
  if (!unit) {
    if (const std::optional<UnitGuess> guess = GuessUnit(scene)) {
      unit = guess->unit;
      scene.notes.push_back(guess->remark);
    } else {
      scene.notes.push_back("The unit is not known: say it for sizes in metres.");
    }
  }
  return unit ? Scaled(std::move(scene), *unit) : scene;
}

}  // namespace mortise::mesh
