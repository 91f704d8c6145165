#include "services/catalog/assembly_export.h"

#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/cylinder.h"
#include "common/cad/solid.h"
#include "common/cad/solid_shape.h"
#include "common/cad/step_writer.h"
#include "common/parametric/rest_pose.h"

namespace mortise::catalog {
namespace {

constexpr double kAlike = 1e9;  // per metre: sizes that differ by less than a nanometre are one
constexpr int kBox = -1;        // round about no axis

// "post" of "post 1.2".
std::string Stem(const std::string& name) {
  std::size_t end = name.size();
  while (end > 0 &&
         (std::isdigit(static_cast<unsigned char>(name[end - 1])) != 0 || name[end - 1] == '.')) {
    --end;
  }
  return end > 1 && end < name.size() && name[end - 1] == ' ' ? name.substr(0, end - 1) : name;
}

// Without a shape everything is a box or round: see parametric::DesignAt.
bool IsRound(const parametric::EvaluatedPart& part) { return part.outline.cols() > 4; }

// With the lower corner of its box at the origin.
absl::StatusOr<cad::Solid> SolidOf(const parametric::EvaluatedPart& part,
                                   const mesh::DrawnShape* drawn, const Eigen::Vector3d& size,
                                   const std::string& name) {
  if (drawn != nullptr) {
    auto solid = cad::SolidOfShape(*drawn, size, name);
    if (absl::IsInvalidArgument(solid.status())) {
      return UnderField(absl::StrCat("part '", part.name, "'"), solid.status());
    }
    return solid;
  }
  const int w = static_cast<int>(part.axis), u = (w + 1) % 3, v = (w + 2) % 3;
  if (IsRound(part)) {
    cad::CylinderShape shape;
    shape.name = name;
    shape.u = Eigen::Vector3d::Unit(u);
    shape.v = Eigen::Vector3d::Unit(v);
    shape.radius_u = size[u] / 2;
    shape.radius_v = size[v] / 2;
    shape.center = shape.radius_u * shape.u + shape.radius_v * shape.v;
    shape.height = size[w];
    return cad::MakeCylinder(shape);
  }
  mesh::PartShape shape;
  shape.name = name;
  shape.outline.resize(2, 4);
  shape.outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
  shape.height = size.z();
  shape.face_names = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
  return cad::Solid::FromPart(shape);
}

// What products are told apart by.
struct Likeness {
  std::string item;
  const mesh::DrawnShape* shape = nullptr;
  int round_about = 0;     // axis, or kBox
  std::vector<long> size;  // nm
  std::vector<double> color;
  auto operator<=>(const Likeness&) const = default;
};

// Makes products of parts, each at the origin.
class ProductMaker {
 public:
  explicit ProductMaker(cad::StepAssembly& step) : step_(step) {}

  // Adds a part, and its product if that is a new one.
  absl::Status Add(const parametric::EvaluatedPart& part, const mesh::DrawnShape* shape, int group,
                   const Eigen::Vector3d& color) {
    const Eigen::Vector3d size = part.maximum - part.minimum;
    Likeness likeness{part.item, shape, kBox, {}, {}};
    if (shape == nullptr && IsRound(part)) likeness.round_about = static_cast<int>(part.axis);
    for (const double length : size) likeness.size.push_back(std::lround(kAlike * length));
    likeness.color.assign(color.begin(), color.end());
    const auto [known, is_new] =
        products_.try_emplace(std::move(likeness), static_cast<int>(step_.products.size()));
    cad::StepPart placed;
    placed.name = part.name;
    placed.group = group;
    placed.product = known->second;
    placed.placement.translation() = part.minimum;
    step_.parts.push_back(std::move(placed));
    if (!is_new) return absl::OkStatus();
    std::string name = Stem(part.name);
    if (!names_.insert(name).second) name = part.name;
    names_.insert(name);
    MORTISE_ASSIGN_OR_RETURN(cad::Solid solid, SolidOf(part, shape, size, name));
    step_.products.push_back({std::move(name), std::move(solid), color});
    return absl::OkStatus();
  }

 private:
  cad::StepAssembly& step_;
  std::map<Likeness, int> products_;
  std::set<std::string> names_;
};

absl::StatusOr<parametric::Pose> PoseOf(const PosedAssembly& posed) {
  std::string known;
  for (parametric::Pose& pose : parametric::PosesOf(posed.assembly.assembly())) {
    if (pose.name == posed.rest_pose) return std::move(pose);
    if (!pose.name.empty()) absl::StrAppend(&known, known.empty() ? "" : ", ", "'", pose.name, "'");
  }
  return InvalidField("rest_pose", absl::StrCat("there is no '", posed.rest_pose, "'; the design ",
                                                known.empty() ? "has none" : "has " + known));
}

Eigen::Isometry3d MotionOf(const PosedAssembly& posed, const parametric::Pose& pose) {
  return parametric::MotionIn(pose, posed.assembly.assembly(), posed.assembly.elements().size(),
                              posed.q);
}

}  // namespace

absl::StatusOr<std::string> ExportAssemblyStep(const PosedAssembly& posed,
                                               const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Pose pose, PoseOf(posed));
  const parametric::ParametricAssembly& assembly = posed.assembly;
  cad::StepAssembly step;
  step.name = name;
  for (const parametric::AssemblyGroup& group : assembly.assembly().groups) {
    step.groups.push_back({group.name, group.parent});
  }
  if (pose.joint >= 0) {
    step.groups[static_cast<std::size_t>(pose.moved_group)].placement = MotionOf(posed, pose);
  }
  const std::vector<parametric::PlacedPart> placed = assembly.PartsAt(posed.q);
  const std::vector<Eigen::Vector3d> colors = PartColors(posed.design);
  ProductMaker products(step);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const int group = assembly.elements()[static_cast<std::size_t>(placed[i].element)].group;
    MORTISE_RETURN_IF_ERROR(
        products.Add(posed.design.parts[i], assembly.ShapeOf(placed[i]).get(), group, colors[i]));
  }
  return cad::WriteStep(step);
}

absl::StatusOr<std::string> ExportAssemblyMesh(const PosedAssembly& posed, MeshFormat format,
                                               const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Pose pose, PoseOf(posed));
  std::vector<Eigen::Isometry3d> motions;
  if (pose.joint >= 0) {
    const Eigen::Isometry3d motion = MotionOf(posed, pose);
    for (const parametric::PlacedPart& part : posed.assembly.PartsAt(posed.q)) {
      const int group = posed.assembly.elements()[static_cast<std::size_t>(part.element)].group;
      const bool moves = parametric::IsWithin(posed.assembly.assembly(), group, pose.moved_group);
      motions.push_back(moves ? motion : Eigen::Isometry3d::Identity());
    }
  }
  return ExportMesh(posed.design, motions, format, name);
}

}  // namespace mortise::catalog
