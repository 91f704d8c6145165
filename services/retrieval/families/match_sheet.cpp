#include "services/retrieval/families/match_sheet.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "common/render/camera.h"
#include "common/render/scene.h"

namespace mortise::retrieval {
namespace {

constexpr int kWidth = 320;   // pixels, of one picture
constexpr int kHeight = 260;  // pixels
constexpr int kColumns = 4;
constexpr render::Color kQueryColor{0.55, 0.72, 0.52};
constexpr render::Color kMatchColor{0.72, 0.76, 0.82};

}  // namespace

absl::StatusOr<render::Image> DrawSurface(const mesh::SurfaceMesh& surface,
                                          const render::Color& color, int width, int height) {
  if (surface.triangles.cols() == 0) return InvalidField("surface", "has no triangles");
  render::Scene scene;
  render::Shape shape;
  shape.vertices = surface.vertices;
  shape.triangles = surface.triangles;
  shape.color = color;
  shape.edge_width = 1;
  scene.shapes.push_back(std::move(shape));
  scene.camera = render::FitCamera(render::BoundingBox(scene), render::kViewIsometric,
                                   static_cast<double>(width) / height);
  return render::Render(scene, {.width = width, .height = height, .supersample = 2});
}

absl::StatusOr<std::string> DrawMatchSheet(const std::vector<SheetEntry>& entries) {
  std::vector<render::Image> pictures;
  std::vector<std::string> captions;
  for (const SheetEntry& entry : entries) {
    MORTISE_ASSIGN_OR_RETURN(
        render::Image picture,
        DrawSurface(entry.surface, pictures.empty() ? kQueryColor : kMatchColor, kWidth, kHeight));
    pictures.push_back(std::move(picture));
    captions.push_back(entry.caption);
  }
  const int columns = std::min(kColumns, static_cast<int>(pictures.size()));
  MORTISE_ASSIGN_OR_RETURN(const render::Image sheet,
                           render::ContactSheet(pictures, captions, columns));
  return render::EncodePng(sheet);
}

}  // namespace mortise::retrieval
