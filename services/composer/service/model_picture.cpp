#include "services/composer/service/model_picture.h"

#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/base/errors.h"
#include "common/design/evaluation.h"
#include "common/files/template_codec.h"
#include "common/render/scene.h"

namespace mortise::composer {
namespace {

constexpr double kPaler = 0.55;  // of white, where it is not connected
constexpr double kDarker = 0.3;  // of black, of what connects
constexpr render::Color kUnmarked{0.82, 0.82, 0.82};
constexpr double kEdgeWidth = 0.9;  // pixels

// The colour of each component, in the order they came in.
std::map<std::string, render::Color> ColorsOf(const OpenModel& model) {
  std::map<std::string, render::Color> colors;
  for (const v1::ModelComponent& component : model.components) {
    colors.emplace(component.id(), render::PartColor(static_cast<int>(colors.size())));
  }
  return colors;
}

// A part that is to be coloured.
struct ColoredPart {
  std::string drawn_as;  // part of the drawing
  std::string name;      // as PlacedPart says
  bool connecting = false;
};

// A colour darker, of what connects.
render::Color Shaded(const render::Color& color, const ColoredPart& part) {
  return part.connecting ? render::Mix(color, {0, 0, 0}, kDarker) : color;
}

// Adds the parts of a design in the colours that `color_of` gives to ColoredPart.
template <typename ColorOf>
absl::Status AddDesign(const OpenModel& model, const OpenDesign& part, ModelDrawings& drawings,
                       const ColorOf& color_of, render::Scene& scene) {
  MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings.Get(model.name, part.drawing));
  std::vector<parametric::Item> items;
  for (const v1::Item& message : drawing->bundle.items()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
    items.push_back(std::move(item));
  }
  const parametric::ParametricAssembly& assembly = *part.design.assembly;
  const parametric::EvaluatedDesign design =
      parametric::DesignAt(assembly, part.design.q, items, {});
  const std::vector<parametric::PlacedPart> placed = assembly.PartsAt(part.design.q);
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const auto& element = assembly.elements()[static_cast<std::size_t>(placed[i].element)];
    const auto drawn = static_cast<std::size_t>(element.parts.front());
    const mesh::SurfaceMesh surface = parametric::PartSurface(design.parts[i]);
    render::Shape shape;
    shape.vertices = surface.vertices.colwise() + part.design.shift;
    shape.triangles = surface.triangles;
    shape.color = color_of(ColoredPart{assembly.assembly().parts[drawn].name, design.parts[i].name,
                                       element.connecting});
    shape.edge_width = kEdgeWidth;
    scene.shapes.push_back(std::move(shape));
  }
  return absl::OkStatus();
}

// The scene from above, as PNG.
absl::StatusOr<std::string> PictureOf(render::Scene scene, int width, int height) {
  scene.camera = render::FitCamera(render::BoundingBox(scene), render::kViewIsometric,
                                   static_cast<double>(width) / height);
  MORTISE_ASSIGN_OR_RETURN(const render::Image image,
                           render::Render(scene, {.width = width, .height = height}));
  return render::EncodePng(image);
}

}  // namespace

absl::StatusOr<std::string> DrawPicture(const OpenModel& model, ModelDrawings& drawings, int width,
                                        int height) {
  if (!model.body) {
    return PreconditionFailed("MODEL_EMPTY", absl::StrCat("nothing is in ", model.name, " yet"),
                              "name");
  }
  const std::map<std::string, render::Color> colors = ColorsOf(model);
  const auto color_of = [&](const std::string& component) {
    const auto found = colors.find(component);
    return found == colors.end() ? render::Color{0.8, 0.8, 0.8} : found->second;
  };
  render::Scene scene;
  MORTISE_RETURN_IF_ERROR(AddDesign(
      model, *model.body, drawings,
      [&](const ColoredPart& part) {
        const auto owner = model.owners.find(part.drawn_as);
        return Shaded(color_of(owner == model.owners.end() ? "" : owner->second), part);
      },
      scene));
  for (const OpenLoose& loose : model.loose) {
    const render::Color pale = render::Mix(color_of(loose.id), {1, 1, 1}, kPaler);
    MORTISE_RETURN_IF_ERROR(AddDesign(
        model, loose.part, drawings, [&](const ColoredPart& part) { return Shaded(pale, part); },
        scene));
  }
  return PictureOf(std::move(scene), width, height);
}

absl::StatusOr<std::string> DrawMarkedParts(const OpenModel& model, ModelDrawings& drawings,
                                            const std::map<std::string, render::Color>& marked,
                                            int width, int height) {
  render::Scene scene;
  MORTISE_RETURN_IF_ERROR(AddDesign(
      model, *model.body, drawings,
      [&](const ColoredPart& part) {
        const auto found = marked.find(part.name);
        return found == marked.end() ? kUnmarked : found->second;
      },
      scene));
  return PictureOf(std::move(scene), width, height);
}

}  // namespace mortise::composer
