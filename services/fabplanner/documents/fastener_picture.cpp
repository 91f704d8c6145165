#include "services/fabplanner/documents/fastener_picture.h"

#include <utility>

#include "common/base/errors.h"
#include "common/render/scene.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "services/fabplanner/documents/step_view.h"

namespace mortise::fabplanner {
namespace {

constexpr int kFastenerWidth = 240;  // px
constexpr int kFastenerHeight = 90;  // px

absl::StatusOr<std::string> DrawLying(render::Shape shape) {
  render::Scene scene;
  if (shape.triangles.cols() > 0) {
    // Its longest side lies along x; the axes keep their order, so that it is not mirrored.
    const Eigen::Vector3d sides =
        shape.vertices.rowwise().maxCoeff() - shape.vertices.rowwise().minCoeff();
    int longest = 0;
    sides.maxCoeff(&longest);
    Eigen::Matrix3Xd turned(3, shape.vertices.cols());
    for (int axis = 0; axis < 3; ++axis) {
      turned.row(axis) = shape.vertices.row((longest + axis) % 3);
    }
    shape.vertices = std::move(turned);
    shape.color = kPegColor;
    scene.shapes.push_back(std::move(shape));
    constexpr double kAspect = static_cast<double>(kFastenerWidth) / kFastenerHeight;
    scene.camera = render::FitCamera(render::BoundingBox(scene), {0.35, -1, 0.5}, kAspect);
  }
  MORTISE_ASSIGN_OR_RETURN(
      const render::Image image,
      render::Render(scene, {.width = kFastenerWidth, .height = kFastenerHeight}));
  return render::EncodePng(image);
}

}  // namespace

absl::StatusOr<std::string> FastenerPicture(const Part& part) {
  return DrawLying(PartShape(part, Eigen::Vector3d::Zero()));
}

absl::StatusOr<std::string> FastenerPicture(const Peg& peg) {
  return DrawLying(PegShape(peg, Eigen::Vector3d::Zero()));
}

}  // namespace mortise::fabplanner
