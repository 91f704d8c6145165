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
constexpr int kMatchColumns = 4;
constexpr int kFitColumns = 3;
constexpr render::Color kQueryColor{0.55, 0.72, 0.52};
constexpr render::Color kDesignColor{0.72, 0.76, 0.82};
constexpr render::Color kOverlayColor{0.1, 0.45, 0.1};

absl::StatusOr<render::Shape> ShapeOf(const mesh::SurfaceMesh& surface,
                                      const render::Color& color) {
  if (surface.triangles.cols() == 0) return InvalidField("surface", "has no triangles");
  render::Shape shape;
  shape.vertices = surface.vertices;
  shape.triangles = surface.triangles;
  shape.color = color;
  shape.edge_width = 1;
  return shape;
}

// The camera that has all of the shapes in its picture.
render::Camera CameraFor(std::vector<render::Shape> shapes, int width, int height) {
  render::Scene scene;
  scene.shapes = std::move(shapes);
  return render::FitCamera(render::BoundingBox(scene), render::kViewIsometric,
                           static_cast<double>(width) / height);
}

absl::StatusOr<render::Image> Draw(std::vector<render::Shape> shapes, const render::Camera& camera,
                                   int width, int height) {
  render::Scene scene;
  scene.shapes = std::move(shapes);
  scene.camera = camera;
  return render::Render(scene, {.width = width, .height = height, .supersample = 2});
}

// Pictures over their captions, in rows.
class Sheet {
 public:
  void Add(render::Image picture, std::string caption) {
    pictures_.push_back(std::move(picture));
    captions_.push_back(std::move(caption));
  }

  bool IsEmpty() const { return pictures_.empty(); }

  absl::StatusOr<std::string> Png(int columns) const {
    columns = std::min(columns, static_cast<int>(pictures_.size()));
    MORTISE_ASSIGN_OR_RETURN(const render::Image sheet,
                             render::ContactSheet(pictures_, captions_, columns));
    return render::EncodePng(sheet);
  }

 private:
  std::vector<render::Image> pictures_;
  std::vector<std::string> captions_;
};

}  // namespace

absl::StatusOr<render::Image> DrawSurface(const mesh::SurfaceMesh& surface,
                                          const render::Color& color, int width, int height) {
  MORTISE_ASSIGN_OR_RETURN(const render::Shape shape, ShapeOf(surface, color));
  return Draw({shape}, CameraFor({shape}, width, height), width, height);
}

absl::StatusOr<std::string> DrawMatchSheet(const std::vector<SheetEntry>& entries) {
  Sheet sheet;
  for (const SheetEntry& entry : entries) {
    MORTISE_ASSIGN_OR_RETURN(
        render::Image picture,
        DrawSurface(entry.surface, sheet.IsEmpty() ? kQueryColor : kDesignColor, kWidth, kHeight));
    sheet.Add(std::move(picture), entry.caption);
  }
  return sheet.Png(kMatchColumns);
}

absl::StatusOr<std::string> DrawFitSheet(const SheetEntry& query,
                                         const std::vector<FitEntry>& designs) {
  if (designs.empty()) return InvalidField("designs", "are none");
  MORTISE_ASSIGN_OR_RETURN(const render::Shape asked, ShapeOf(query.surface, kQueryColor));
  render::Shape outline = asked;
  outline.filled = false;
  outline.edge_color = kOverlayColor;
  Sheet sheet;
  for (const auto& [design, comparison] : designs) {
    MORTISE_ASSIGN_OR_RETURN(const render::Shape fitted, ShapeOf(design.surface, kDesignColor));
    const render::Camera camera = CameraFor({asked, fitted}, kWidth, kHeight);
    const auto add = [&](std::vector<render::Shape> shapes, std::string caption) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(render::Image picture,
                               Draw(std::move(shapes), camera, kWidth, kHeight));
      sheet.Add(std::move(picture), std::move(caption));
      return absl::OkStatus();
    };
    MORTISE_RETURN_IF_ERROR(add({asked}, query.caption));
    MORTISE_RETURN_IF_ERROR(add({fitted}, design.caption));
    MORTISE_RETURN_IF_ERROR(add({fitted, outline}, comparison));
  }
  return sheet.Png(kFitColumns);
}

}  // namespace mortise::retrieval
