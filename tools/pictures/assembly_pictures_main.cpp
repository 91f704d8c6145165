// Draws the assemblies of a collection as they are written, side by side in one picture:
// assembly_pictures collection docs/pictures/assemblies.png [WIDTH [NAME…]], `WIDTH` in pixels of
// each, and of all assemblies if no name is given.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "common/assembly/assembly_design.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/design/evaluation.h"
#include "common/files/collection.h"
#include "common/files/template_codec.h"
#include "common/render/scene.h"
#include "services/catalog/exchange/design_export.h"

namespace {

using namespace mortise;

struct Things {
  std::vector<parametric::Item> items;
  std::vector<parametric::Material> materials;
  parametric::ShapesByName shapes;
};

absl::StatusOr<Things> ThingsOf(const parametric::Collection& collection) {
  Things things;
  for (const v1::Item& message : collection.items) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
    things.items.push_back(std::move(item));
  }
  for (const v1::Material& message : collection.materials) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Material material, parametric::FromProto(message));
    things.materials.push_back(std::move(material));
  }
  MORTISE_ASSIGN_OR_RETURN(things.shapes,
                           parametric::FromProto(google::protobuf::RepeatedPtrField<v1::Shape>(
                               collection.shapes.begin(), collection.shapes.end())));
  return things;
}

// Colours of parts are linear, those of pictures as screens have them.
render::Color OnScreen(const Eigen::Vector3d& linear) {
  const Eigen::Vector3d color = linear.array().pow(1 / 2.2);
  return {color.x(), color.y(), color.z()};
}

absl::StatusOr<render::Image> Draw(const v1::Assembly& message, const Things& things, int width) {
  MORTISE_ASSIGN_OR_RETURN(parametric::Assembly read,
                           parametric::FromProto(message, things.items, things.shapes));
  MORTISE_ASSIGN_OR_RETURN(const parametric::ParametricAssembly assembly,
                           parametric::ParametricAssembly::Create(std::move(read)));
  const parametric::EvaluatedDesign design =
      parametric::DesignAt(assembly, assembly.drawn(), things.items, things.materials);
  const std::vector<Eigen::Vector3d> colors = catalog::PartColors(design);
  render::Scene scene;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const mesh::SurfaceMesh surface = parametric::PartSurface(design.parts[i]);
    render::Shape shape;
    shape.vertices = surface.vertices;
    shape.triangles = surface.triangles;
    shape.color = OnScreen(colors[i]);
    shape.edge_width = 0.9;
    scene.shapes.push_back(std::move(shape));
  }
  const int height = width * 3 / 4;
  scene.camera = render::FitCamera(render::BoundingBox(scene), render::kViewIsometric,
                                   static_cast<double>(width) / height);
  return render::Render(scene, {.width = width, .height = height});
}

absl::Status DrawAll(const std::string& folder, const std::string& file, int width,
                     const std::vector<std::string>& names) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Collection collection,
                           parametric::ReadCollection(folder));
  MORTISE_ASSIGN_OR_RETURN(const Things things, ThingsOf(collection));
  std::vector<render::Image> pictures;
  std::vector<std::string> captions;
  for (const v1::Assembly& assembly : collection.assemblies) {
    const std::string id = assembly.name().substr(assembly.name().find('/') + 1);
    if (!names.empty() && std::find(names.begin(), names.end(), id) == names.end()) continue;
    MORTISE_ASSIGN_OR_RETURN(render::Image picture, Draw(assembly, things, width));
    pictures.push_back(std::move(picture));
    captions.push_back(assembly.title());
  }
  constexpr int kColumns = 5;
  MORTISE_ASSIGN_OR_RETURN(const render::Image sheet,
                           render::ContactSheet(pictures, captions, kColumns));
  MORTISE_ASSIGN_OR_RETURN(const std::string png, render::EncodePng(sheet));
  return WriteFile(file, png);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) {
    std::cerr << "Usage: assembly_pictures COLLECTION FILE [WIDTH [NAME...]]\n";
    return 2;
  }
  const int width = count > 3 ? std::atoi(arguments[3]) : 360;
  const std::vector<std::string> names(arguments + std::min(count, 4), arguments + count);
  const absl::Status drawn = DrawAll(arguments[1], arguments[2], width, names);
  if (!drawn.ok()) std::cerr << drawn << "\n";
  return drawn.ok() ? 0 : 1;
}
