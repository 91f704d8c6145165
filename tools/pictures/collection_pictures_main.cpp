// Draws templates of a collection at their defaults, side by side in one picture:
// collection_pictures collection docs/pictures/assemblies.png [--width PIXELS] [--random COUNT]
// [NAME…] Of all assemblies if no name is given. With --random each template has a row of its own,
// with as many designs behind the default one at random parameters, and a line is printed that says
// how many random parameters there were until these could be made, and how long evaluating took.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/design/evaluation.h"
#include "common/design/parameter_values.h"
#include "common/files/collection.h"
#include "common/render/scene.h"
#include "common/templates/template_codec.h"
#include "services/catalog/exchange/design_export.h"

namespace {

using namespace mortise;

constexpr int kColumns = 5;
constexpr int kMaxTries = 1000;  // random parameters of one template

struct Request {
  std::string folder;
  std::string file;
  int width = 360;  // pixels of each picture
  int random = 0;   // designs besides the default one
  std::vector<std::string> names;
};

struct Sheet {
  std::vector<render::Image> pictures;
  std::vector<std::string> captions;
};

// Colours of parts are linear, those of pictures as screens have them.
render::Color OnScreen(const Eigen::Vector3d& linear) {
  const Eigen::Vector3d color = linear.array().pow(1 / 2.2);
  return {color.x(), color.y(), color.z()};
}

absl::StatusOr<render::Image> Draw(const parametric::EvaluatedDesign& design, int width) {
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

// A template by its id, or that of the assembly of this id, with all that the collection has.
absl::StatusOr<std::shared_ptr<const templates::Template>> Compiled(
    const parametric::Collection& collection, const std::string& id) {
  v1::TemplateBundle bundle;
  *bundle.mutable_items() = {collection.items.begin(), collection.items.end()};
  *bundle.mutable_materials() = {collection.materials.begin(), collection.materials.end()};
  *bundle.mutable_shapes() = {collection.shapes.begin(), collection.shapes.end()};
  for (const v1::Template& message : collection.templates) {
    if (message.name() == "templates/" + id) *bundle.mutable_template_() = message;
  }
  std::string drawn = bundle.template_().assembly().assembly();
  if (bundle.template_().name().empty()) {
    drawn = "assemblies/" + id;
    bundle.mutable_template_()->set_name("templates/" + id);
    bundle.mutable_template_()->mutable_assembly()->set_assembly(drawn);
  }
  for (const v1::Assembly& message : collection.assemblies) {
    if (message.name() == drawn) *bundle.mutable_assembly() = message;
  }
  if (!drawn.empty() && !bundle.has_assembly()) return ResourceNotFound(drawn);
  MORTISE_RETURN_IF_ERROR(
      UnderField(id, templates::FillAndCheck(bundle, templates::Trial::kDefaults)));
  return templates::Compile(bundle);
}

// Random designs, and what is told of them.
absl::Status AddRandomDesigns(const templates::Template& function, const Request& request,
                              Sheet& sheet) {
  std::mt19937_64 random(1);
  int tried = 0, made = 0;
  std::chrono::duration<double, std::milli> spent{};
  std::string refusal;
  while (made < request.random && tried < kMaxTries) {
    ++tried;
    Eigen::VectorXd q = parametric::Defaults(function.parameters());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const parametric::Parameter& range = function.parameters()[static_cast<std::size_t>(i)];
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      q[i] = range.minimum + share * (range.maximum - range.minimum);
    }
    const auto began = std::chrono::steady_clock::now();
    const auto design = function.Evaluate(q);
    spent += std::chrono::steady_clock::now() - began;
    if (!design.ok()) {
      if (refusal.empty()) refusal = std::string(design.status().message());
      continue;
    }
    ++made;
    MORTISE_ASSIGN_OR_RETURN(render::Image picture, Draw(*design, request.width));
    sheet.pictures.push_back(std::move(picture));
    sheet.captions.push_back("");
  }
  std::cout << function.head().name << ": " << made << " designs of " << tried
            << " random parameters, " << spent.count() / std::max(tried, 1) << " ms each\n";
  if (!refusal.empty()) std::cout << "  refused: " << refusal << "\n";
  if (made == request.random) return absl::OkStatus();
  return PreconditionFailed("NO_FEASIBLE_DESIGN", function.head().name);
}

absl::Status DrawAll(const Request& request) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Collection collection,
                           parametric::ReadCollection(request.folder));
  std::vector<std::string> names = request.names;
  if (names.empty()) {
    for (const v1::Assembly& assembly : collection.assemblies) {
      names.push_back(assembly.name().substr(assembly.name().find('/') + 1));
    }
  }
  Sheet sheet;
  for (const std::string& name : names) {
    MORTISE_ASSIGN_OR_RETURN(const auto function, Compiled(collection, name));
    MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design,
                             function->Evaluate(parametric::Defaults(function->parameters())));
    MORTISE_ASSIGN_OR_RETURN(render::Image picture, Draw(design, request.width));
    sheet.pictures.push_back(std::move(picture));
    sheet.captions.push_back(function->head().title);
    if (request.random == 0) continue;
    MORTISE_RETURN_IF_ERROR(AddRandomDesigns(*function, request, sheet));
  }
  const int columns = request.random > 0 ? request.random + 1 : kColumns;
  MORTISE_ASSIGN_OR_RETURN(const render::Image image,
                           render::ContactSheet(sheet.pictures, sheet.captions, columns));
  MORTISE_ASSIGN_OR_RETURN(const std::string png, render::EncodePng(image));
  return WriteFile(request.file, png);
}

}  // namespace

int main(int count, char** arguments) {
  Request request;
  std::vector<std::string> words;
  bool understood = true;
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    int* const number = word == "--width"    ? &request.width
                        : word == "--random" ? &request.random
                                             : nullptr;
    if (number == nullptr) {
      words.push_back(word);
    } else {
      understood = understood && ++i < count && absl::SimpleAtoi(arguments[i], number);
    }
  }
  if (!understood || words.size() < 2) {
    std::cerr << "Usage: collection_pictures COLLECTION FILE [--width PIXELS] [--random COUNT] "
                 "[NAME...]\n";
    return 2;
  }
  request.folder = words[0];
  request.file = words[1];
  request.names.assign(words.begin() + 2, words.end());
  const absl::Status drawn = DrawAll(request);
  if (!drawn.ok()) std::cerr << drawn << "\n";
  return drawn.ok() ? 0 : 1;
}
