#include "services/catalog/exchange/mesh_drawing.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/mesh/parts/scene_parts.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "services/catalog/exchange/part_gaps.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

// Shares of the diagonal of the whole.
constexpr double kThin = 2e-5;       // boxes no thicker get a thickness
constexpr double kThickness = 1e-4;  // which is this
constexpr double kTolerance = 1e-5;  // planes that are nearer lie in one
constexpr double kMaxMoved = 2;      // tolerances, of what lies between such planes

constexpr double kMaxTolerance = 1e-3;   // m
constexpr double kMinMesh = 1e-4;        // m, its diagonal
constexpr double kFurthest = 10e3;       // m, from the origin
constexpr double kAlmostAll = 1 - 1e-6;  // of its box: what fills it
const char* const kNameless = "part";

double Diagonal(const cad::StepAssembly& drawing) {
  Eigen::AlignedBox3d box;
  for (const cad::StepPart& part : drawing.parts) {
    box.extend(part.minimum);
    box.extend(part.maximum);
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

absl::Status CheckExtent(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return InvalidField("file", "has no triangle that has an area");
  const double diagonal = box.diagonal().norm();
  if (!(diagonal >= kMinMesh)) {
    return InvalidField("file", absl::StrFormat("measures %g m across, less than %g m: is its unit "
                                                "of length another one?",
                                                diagonal, kMinMesh));
  }
  const double furthest =
      std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  if (!(furthest <= kFurthest)) {
    return InvalidField("file", absl::StrFormat("reaches %g m from the origin, more than %g m: is "
                                                "its unit of length another one?",
                                                furthest, kFurthest));
  }
  return absl::OkStatus();
}

// The box around a part, as thick as one must be.
Eigen::AlignedBox3d PartBox(const mesh::SurfaceMesh& surface, double diagonal) {
  Eigen::AlignedBox3d box = mesh::BoxOf(surface);
  for (int axis = 0; axis < 3; ++axis) {
    if (box.sizes()[axis] > kThin * diagonal) continue;
    const double middle = box.center()[axis];
    box.min()[axis] = middle - kThickness * diagonal / 2;
    box.max()[axis] = middle + kThickness * diagonal / 2;
  }
  return box;
}

class Drawer {
 public:
  Drawer(const mesh::SceneParts& scene, double diagonal) : scene_(scene), diagonal_(diagonal) {}

  absl::StatusOr<cad::StepAssembly> Draw(const std::string& name) {
    drawing_.name = name;
    drawing_.notes = scene_.notes;
    AddGroups(name);
    const std::vector<std::string> names = PartNames();
    for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
      MORTISE_RETURN_IF_ERROR(AddPart(i, names[i]));
    }
    CloseGapsOfParts();
    AddNoteOnSurfaces();
    return std::move(drawing_);
  }

 private:
  void AddGroups(const std::string& name) {
    drawing_.groups.emplace_back().name = name;
    std::vector<std::string> drawn;
    for (const mesh::ScenePart& part : scene_.parts) {
      if (!part.group.empty() && group_of_.try_emplace(part.group, drawn.size() + 1).second) {
        drawn.push_back(part.group);
      }
    }
    for (const std::string& distinct : cad::DistinctNames(drawn, "group")) {
      cad::StepGroup& group = drawing_.groups.emplace_back();
      group.name = distinct;
      group.parent = 0;
    }
  }

  std::vector<std::string> PartNames() const {
    std::vector<std::string> drawn;
    for (const mesh::ScenePart& part : scene_.parts) drawn.push_back(part.name);
    return cad::DistinctNames(drawn, kNameless);
  }

  absl::Status AddPart(std::size_t index, const std::string& name) {
    const mesh::ScenePart& drawn = scene_.parts[index];
    const Eigen::AlignedBox3d box = PartBox(drawn.surface, diagonal_);
    cad::StepPart part;
    part.name = name;
    part.drawn_name = drawn.name.empty() ? name : drawn.name;
    part.group = drawn.group.empty() ? 0 : static_cast<int>(group_of_.at(drawn.group));
    part.minimum = box.min();
    part.maximum = box.max();
    const auto first = static_cast<std::size_t>(drawn.first_alike);
    if (first < index) {
      const cad::StepPart& alike = drawing_.parts[first];
      part.product = alike.product;
      part.volume = alike.volume;
      part.is_box = alike.is_box;
      part.shape = alike.shape;
      // Alike to the last digit, so that rows of them are found.
      const Eigen::Vector3d size = alike.maximum - alike.minimum;
      part.minimum = box.center() - size / 2;
      part.maximum = part.minimum + size;
    } else {
      MORTISE_RETURN_IF_ERROR(AddShape(drawn, IsGapped(index), box, part));
    }
    drawing_.parts.push_back(std::move(part));
    return absl::OkStatus();
  }

  // Whether a part, or one that is alike, nearly touches another.
  bool IsGapped(std::size_t index) const {
    return std::any_of(scene_.parts.begin(), scene_.parts.end(), [&](const mesh::ScenePart& part) {
      return part.first_alike == static_cast<int>(index) && part.has_gap;
    });
  }

  absl::Status AddShape(const mesh::ScenePart& drawn, bool is_gapped,
                        const Eigen::AlignedBox3d& box, cad::StepPart& part) {
    absl::StatusOr<mesh::DrawnShape> shape =
        mesh::ShapeOfSurface(drawn.surface, box.min(), box.max());
    if (absl::IsResourceExhausted(shape.status())) {
      return TooLarge("file", absl::StrCat("the ", mesh::kMaxShapeTriangles,
                                           " triangles that a part may have: '", part.name,
                                           "' has ", drawn.surface.triangles.cols()));
    }
    if (!shape.ok()) {
      return InvalidField("file", absl::StrCat("'", part.name, "': ", shape.status().message()));
    }
    part.product = static_cast<int>(drawing_.products.size());
    drawing_.products.emplace_back().name = part.drawn_name;
    part.volume = shape->volume;
    part.is_box = shape->is_solid && shape->volume >= kAlmostAll * shape->size.prod();
    if (part.is_box && !is_gapped) return absl::OkStatus();
    // Planes that nearly are one become one (ToleranceOfMesh), and take what lies between them
    // along: corners and edges that met are a little apart then, and still touch.
    shape->deflection =
        (is_gapped ? mesh::PartGroupingOptions().contact / 2 : kMaxMoved * kTolerance) * diagonal_;
    if (!shape->is_solid) surfaces_.push_back(part.name);
    shape->name = NamedShape(*shape).name();
    part.shape = static_cast<int>(drawing_.shapes.size());
    drawing_.shapes.push_back(*std::move(shape));
    return absl::OkStatus();
  }

  // What counts as contact becomes one.
  void CloseGapsOfParts() {
    std::vector<int> first_alike;
    std::vector<Eigen::AlignedBox3d> boxes;
    for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
      first_alike.push_back(scene_.parts[i].first_alike);
      boxes.emplace_back(drawing_.parts[i].minimum, drawing_.parts[i].maximum);
    }
    CloseGaps(mesh::PartGroupingOptions().contact * diagonal_, first_alike, boxes);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      drawing_.parts[i].minimum = boxes[i].min();
      drawing_.parts[i].maximum = boxes[i].max();
    }
  }

  void AddNoteOnSurfaces() {
    if (surfaces_.empty()) return;
    drawing_.notes.push_back(absl::StrCat(
        surfaces_.size(), surfaces_.size() == 1 ? " shape is" : " shapes are",
        " only a surface, not the boundary of one solid, such as '", surfaces_.front(),
        "': it can be pictured and compared, but neither analysed nor written as STEP."));
  }

  const mesh::SceneParts& scene_;
  const double diagonal_;
  cad::StepAssembly drawing_;
  std::map<std::string, std::size_t> group_of_;  // by drawn name, index into the drawing's groups
  std::vector<std::string> surfaces_;            // names of the first parts that have such a shape
};

}  // namespace

absl::StatusOr<cad::StepAssembly> DrawingOfScene(mesh::Scene scene, const std::string& name,
                                                 const MeshDrawingOptions& options) {
  if (options.most_parts < 1 || options.most_parts > kMaxMeshParts) {
    return InvalidField("most_parts", absl::StrCat("must be 1 to ", kMaxMeshParts));
  }
  scene = mesh::Settled(std::move(scene), options.up, options.unit);
  const Eigen::AlignedBox3d box = mesh::BoxOf(scene);
  MORTISE_RETURN_IF_ERROR(CheckExtent(box));
  MORTISE_ASSIGN_OR_RETURN(mesh::SceneParts parts, mesh::PartsOf(scene, options.most_parts));
  parts.notes.insert(parts.notes.begin(), scene.notes.begin(), scene.notes.end());
  return Drawer(parts, box.diagonal().norm()).Draw(name);
}

double ToleranceOfMesh(const cad::StepAssembly& drawing) {
  return std::min(kTolerance * Diagonal(drawing), kMaxTolerance);
}

}  // namespace mortise::catalog
