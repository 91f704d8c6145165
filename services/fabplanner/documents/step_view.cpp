#include "services/fabplanner/documents/step_view.h"

#include <utility>

#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

constexpr int kPictureWidth = 900;   // px
constexpr int kPictureHeight = 675;  // px
constexpr double kAspect = static_cast<double>(kPictureWidth) / kPictureHeight;

// How many pixels of a small picture show the added parts: theirs is the one strong colour.
absl::StatusOr<int> VisiblePixels(render::Scene scene, const Eigen::Vector3d& direction) {
  scene.lines.clear();
  for (render::Shape& shape : scene.shapes) shape.edges = false;
  scene.camera = render::FitCamera(render::BoundingBox(scene), direction, kAspect);
  MORTISE_ASSIGN_OR_RETURN(const render::Image image,
                           render::Render(scene, {.width = 180, .height = 135, .supersample = 1}));
  int visible = 0;
  for (std::size_t i = 0; i + 2 < image.pixels.size(); i += 3) {
    visible += image.pixels[i] > image.pixels[i + 2] + 30 ? 1 : 0;
  }
  return visible;
}

}  // namespace

absl::StatusOr<Eigen::Vector3d> ChooseView(const render::Scene& scene) {
  const Eigen::Vector3d usual = render::kViewIsometric;
  Eigen::Vector3d best = usual;
  double best_score = -1;
  for (double z : {1.0, -1.0}) {
    for (const auto& [x, y] : {std::pair(1, 1), {-1, 1}, {-1, -1}, {1, -1}}) {
      const Eigen::Vector3d direction(x * usual.x(), y * usual.y(), z * usual.z());
      MORTISE_ASSIGN_OR_RETURN(const int visible, VisiblePixels(scene, direction));
      // People know a thing from the front and above; other views must be worth it.
      const double habit = (z < 0 ? 0.6 : 1.0) * (x == 1 && y == 1 ? 1.25 : y == 1 ? 1.1 : 1.0);
      if (visible * habit <= best_score) continue;
      best_score = visible * habit;
      best = direction;
    }
  }
  return best;
}

absl::StatusOr<std::string> RenderStep(render::Scene scene, const Eigen::Vector3d& view) {
  scene.camera = render::FitCamera(render::BoundingBox(scene), view, kAspect);
  MORTISE_ASSIGN_OR_RETURN(
      const render::Image image,
      render::Render(scene, {.width = kPictureWidth, .height = kPictureHeight}));
  return render::EncodePng(image);
}

}  // namespace mortise::fabplanner
