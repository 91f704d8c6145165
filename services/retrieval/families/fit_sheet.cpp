#include "services/retrieval/families/fit_sheet.h"

#include <utility>

#include "common/base/errors.h"
#include "common/render/camera.h"
#include "common/render/image.h"
#include "common/render/scene.h"

namespace mortise::retrieval {
namespace {

constexpr int kWidth = 320;   // pixels, of one picture
constexpr int kHeight = 260;  // pixels
constexpr int kColumns = 3;
constexpr render::Color kQueryColor{0.55, 0.72, 0.52};
constexpr render::Color kDesignColor{0.72, 0.76, 0.82};
constexpr render::Color kOverlayColor{0.1, 0.45, 0.1};

render::Shape ShapeOf(const mesh::SurfaceMesh& surface, const render::Color& color) {
  render::Shape shape;
  shape.vertices = surface.vertices;
  shape.triangles = surface.triangles;
  shape.color = color;
  shape.edge_width = 1;
  return shape;
}

absl::StatusOr<render::Image> Draw(std::vector<render::Shape> shapes,
                                   const render::Camera& camera) {
  render::Scene scene;
  scene.shapes = std::move(shapes);
  scene.camera = camera;
  return render::Render(scene, {.width = kWidth, .height = kHeight, .supersample = 2});
}

}  // namespace

absl::StatusOr<std::string> DrawFitSheet(const FitSheetEntry& query,
                                         const std::vector<FitSheetEntry>& designs) {
  if (designs.empty()) return InvalidField("designs", "are none");
  std::vector<render::Image> pictures;
  std::vector<std::string> captions;
  const render::Shape asked = ShapeOf(query.surface, kQueryColor);
  render::Shape outline = asked;
  outline.filled = false;
  outline.edge_color = kOverlayColor;
  for (const FitSheetEntry& design : designs) {
    if (query.surface.triangles.cols() == 0 || design.surface.triangles.cols() == 0) {
      return InvalidField("surface", "has no triangles");
    }
    const render::Shape fitted = ShapeOf(design.surface, kDesignColor);
    render::Scene both;
    both.shapes = {asked, fitted};
    const render::Camera camera = render::FitCamera(
        render::BoundingBox(both), render::kViewIsometric, static_cast<double>(kWidth) / kHeight);
    for (const auto& shapes : {std::vector{asked}, {fitted}, {fitted, outline}}) {
      MORTISE_ASSIGN_OR_RETURN(render::Image picture, Draw(shapes, camera));
      pictures.push_back(std::move(picture));
    }
    captions.insert(captions.end(), {query.caption, design.caption, "both"});
  }
  MORTISE_ASSIGN_OR_RETURN(const render::Image sheet,
                           render::ContactSheet(pictures, captions, kColumns));
  return render::EncodePng(sheet);
}

}  // namespace mortise::retrieval
