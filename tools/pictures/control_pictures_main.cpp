// Draws what of nodes of an assembly that ships can be dragged (thesis, Figure 5-3):
// control_pictures collection docs/pictures/controls.png ASSEMBLY NODE…
// The node is drawn in full colour, all else pale. An arrow through the middle of its box is a
// control of its place, a ball on a face one of its size; what is determined has none.
#include <cmath>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/design/evaluation.h"
#include "common/files/collection.h"
#include "common/files/template_codec.h"
#include "common/render/scene.h"
#include "services/composer/model/controls.h"

namespace {

using namespace mortise;
using composer::Control;
using composer::ControlKind;

constexpr render::Color kNode{0.80, 0.62, 0.38};
constexpr render::Color kOthers{0.93, 0.92, 0.90};
constexpr render::Color kPaleEdge{0.75, 0.75, 0.75};
constexpr render::Color kAxes[] = {{0.80, 0.15, 0.15}, {0.15, 0.55, 0.20}, {0.15, 0.30, 0.80}};
constexpr int kWidth = 640, kHeight = 480;  // pixels

render::Shape Ball(const Eigen::Vector3d& center, double radius, const render::Color& color) {
  constexpr int kAround = 20, kUp = 10;
  constexpr double kPi = 3.14159265358979323846;
  render::Shape ball;
  ball.vertices.resize(3, kAround * (kUp + 1));
  ball.triangles.resize(3, 2 * kAround * kUp);
  for (int up = 0; up <= kUp; ++up) {
    for (int around = 0; around < kAround; ++around) {
      const double height = kPi * up / kUp, turn = 2 * kPi * around / kAround;
      ball.vertices.col(up * kAround + around) =
          center + radius * Eigen::Vector3d(std::sin(height) * std::cos(turn),
                                            std::sin(height) * std::sin(turn), -std::cos(height));
    }
  }
  for (int up = 0; up < kUp; ++up) {
    for (int around = 0; around < kAround; ++around) {
      const int a = up * kAround + around, b = up * kAround + (around + 1) % kAround;
      const int first = 2 * (up * kAround + around);
      ball.triangles.col(first) << a, b, b + kAround;
      ball.triangles.col(first + 1) << a, b + kAround, a + kAround;
    }
  }
  ball.color = color;
  ball.smooth = true;
  ball.edges = false;
  return ball;
}

absl::StatusOr<composer::Design> Read(const parametric::Collection& collection,
                                      const std::string& id) {
  std::vector<parametric::Item> items;
  for (const v1::Item& message : collection.items) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
    items.push_back(std::move(item));
  }
  MORTISE_ASSIGN_OR_RETURN(const parametric::ShapesByName shapes,
                           parametric::FromProto(google::protobuf::RepeatedPtrField<v1::Shape>(
                               collection.shapes.begin(), collection.shapes.end())));
  for (const v1::Assembly& message : collection.assemblies) {
    if (message.name() != "assemblies/" + id) continue;
    MORTISE_ASSIGN_OR_RETURN(parametric::Assembly assembly,
                             parametric::FromProto(message, items, shapes));
    return composer::AsDrawn(std::move(assembly));
  }
  return ResourceNotFound("assemblies/" + id);
}

// Adds a control of a box to the scene, in the colour of its axis.
void AddControl(const Control& control, const parametric::BoundingBox& box, double unit,
                render::Scene& scene) {
  const auto axis = static_cast<Eigen::Index>(control.axis);
  const render::Color& color = kAxes[axis];
  Eigen::Vector3d outwards = Eigen::Vector3d::Zero();
  outwards[axis] = axis == 1 ? -1 : 1;  // to where it is seen
  const Eigen::Vector3d face = box.center() + box.size()[axis] / 2 * outwards;
  if (control.kind == ControlKind::kSize) {
    scene.shapes.push_back(Ball(face + 0.022 * unit * outwards, 0.02 * unit, color));
    return;
  }
  render::Line arrow;
  arrow.points.resize(3, 2);
  arrow.points << box.center(), face + 0.14 * unit * outwards;
  arrow.color = color;
  arrow.width = 3;
  arrow.arrow = arrow.on_top = true;
  scene.lines.push_back(std::move(arrow));
}

absl::StatusOr<render::Image> Draw(const composer::Design& design, const std::string& node) {
  const parametric::ParametricAssembly& assembly = *design.assembly;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<std::string> below,
                           parametric::PartsOfNode(assembly.assembly(), node));
  const std::set<std::string> of_node(below.begin(), below.end());
  const parametric::EvaluatedDesign drawn = parametric::DesignAt(assembly, design.q, {}, {});
  const std::vector<parametric::PlacedPart> placed = composer::PartsOf(design);
  render::Scene scene;
  parametric::BoundingBox box;
  bool is_first = true;
  for (std::size_t i = 0; i < drawn.parts.size(); ++i) {
    const mesh::SurfaceMesh surface = parametric::PartSurface(drawn.parts[i]);
    render::Shape shape;
    shape.vertices = surface.vertices;
    shape.triangles = surface.triangles;
    const bool is_below = of_node.contains(placed[i].name);
    shape.color = is_below ? kNode : kOthers;
    if (!is_below) shape.edge_color = kPaleEdge;
    shape.edge_width = 0.9;
    scene.shapes.push_back(std::move(shape));
    const auto& element = assembly.elements()[static_cast<std::size_t>(placed[i].element)];
    if (!is_below || element.connecting) continue;
    if (is_first) box = placed[i].box;
    is_first = false;
    box.minimum = box.minimum.cwiseMin(placed[i].box.minimum);
    box.maximum = box.maximum.cwiseMax(placed[i].box.maximum);
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Control> controls, composer::ControlsOf(design, node));
  const double unit = composer::BoundsOf(design).size().maxCoeff();
  for (const Control& control : controls) AddControl(control, box, unit, scene);
  scene.camera = render::FitCamera(render::BoundingBox(scene), render::kViewIsometric,
                                   static_cast<double>(kWidth) / kHeight);
  return render::Render(scene, {.width = kWidth, .height = kHeight});
}

absl::Status DrawAll(const std::vector<std::string>& words) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Collection collection,
                           parametric::ReadCollection(words[0]));
  MORTISE_ASSIGN_OR_RETURN(const composer::Design design, Read(collection, words[2]));
  std::vector<render::Image> pictures;
  std::vector<std::string> captions;
  for (std::size_t i = 3; i < words.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(render::Image picture, Draw(design, words[i]));
    pictures.push_back(std::move(picture));
    captions.push_back(words[i].empty() ? words[2] : words[i]);
  }
  MORTISE_ASSIGN_OR_RETURN(
      const render::Image sheet,
      render::ContactSheet(pictures, captions, static_cast<int>(pictures.size())));
  MORTISE_ASSIGN_OR_RETURN(const std::string png, render::EncodePng(sheet));
  return WriteFile(words[1], png);
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.size() < 4) {
    std::cerr << "Usage: control_pictures COLLECTION FILE ASSEMBLY NODE...\n";
    return 2;
  }
  const absl::Status drawn = DrawAll(words);
  if (!drawn.ok()) std::cerr << drawn << "\n";
  return drawn.ok() ? 0 : 1;
}
