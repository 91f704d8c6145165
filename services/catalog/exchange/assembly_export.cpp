#include "services/catalog/exchange/assembly_export.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/rest_pose.h"
#include "common/base/errors.h"
#include "common/cad/cylinder.h"
#include "common/cad/solid.h"
#include "common/cad/step/step_writer.h"
#include "common/cad/stretch/solid_shape.h"
#include "services/catalog/exchange/shape_turn.h"

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

// From the axes of a part's item to the design's; of what is of none, these are the same.
Eigen::Matrix3d TurnOfItem(const parametric::EvaluatedPart& part) {
  if (part.item.empty()) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d turn;
  turn.col(0) = Eigen::Vector3d::Unit(static_cast<int>(part.length_axis));
  turn.col(2) = Eigen::Vector3d::Unit(static_cast<int>(part.thickness_axis));
  turn.col(1) = turn.col(2).cross(turn.col(0));
  return turn;
}

// The shape before it was turned. Its faces and planes are those it has now, which solids do not
// ask for.
mesh::DrawnShape TurnedBack(mesh::DrawnShape shape) {
  const Eigen::Matrix3d back = shape.turn.transpose();
  shape.size = (back * shape.size).cwiseAbs();
  shape.fractions = back * shape.fractions;
  shape.turn.setIdentity();
  return shape;
}

// Shapes that products have, each with those that are it, turned.
class ProductShapes {
 public:
  struct Turned {
    std::shared_ptr<const mesh::DrawnShape> shape;  // as the product has it
    Eigen::Matrix3d turn;                           // from the product's axes to the design's
  };

  // Of a part of this item that has this shape, stretched so.
  Turned Of(const std::string& item, const mesh::DrawnShape& shape,
            const mesh::BoxStretch& stretch) {
    const mesh::DrawnShape* divided = stretch.IsInProportion() ? nullptr : &shape;
    const auto [known, is_new] = known_.try_emplace({item, shape.name, divided});
    if (is_new) known->second = AmongDrawn(item, TurnedBack(shape));
    return {known->second.shape, shape.turn * known->second.turn};
  }

 private:
  Turned AmongDrawn(const std::string& item, mesh::DrawnShape shape) {
    auto& drawn = drawn_[item];
    for (const auto& other : drawn) {
      if (const auto turn = TurnBetween(*other, shape)) return {other, *turn};
    }
    drawn.push_back(std::make_shared<const mesh::DrawnShape>(std::move(shape)));
    return {drawn.back(), Eigen::Matrix3d::Identity()};
  }

  // By item and name, before its turn; divided differently, one name has several surfaces.
  std::map<std::tuple<std::string, std::string, const mesh::DrawnShape*>, Turned> known_;
  std::map<std::string, std::vector<std::shared_ptr<const mesh::DrawnShape>>> drawn_;  // by item
};

// With the lower corner of its box, along the product's axes, at the origin.
absl::StatusOr<cad::Solid> SolidOf(const parametric::EvaluatedPart& part,
                                   const mesh::DrawnShape* shape, const mesh::BoxStretch& stretch,
                                   int round_about, const std::string& name) {
  const Eigen::Vector3d& size = stretch.size;
  if (shape != nullptr) {
    auto solid = cad::SolidOfShape(*shape, stretch, name);
    if (absl::IsInvalidArgument(solid.status())) {
      return UnderField(absl::StrCat("part '", part.name, "'"), solid.status());
    }
    return solid;
  }
  if (round_about != kBox) {
    const int w = round_about, u = (w + 1) % 3, v = (w + 2) % 3;
    cad::CylinderShape cylinder;
    cylinder.name = name;
    cylinder.u = Eigen::Vector3d::Unit(u);
    cylinder.v = Eigen::Vector3d::Unit(v);
    cylinder.radius_u = size[u] / 2;
    cylinder.radius_v = size[v] / 2;
    cylinder.center = cylinder.radius_u * cylinder.u + cylinder.radius_v * cylinder.v;
    cylinder.height = size[w];
    return cad::MakeCylinder(cylinder);
  }
  mesh::PartShape box;
  box.name = name;
  box.outline.resize(2, 4);
  box.outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
  box.height = size.z();
  box.face_names = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
  return cad::Solid::FromPart(box);
}

// What is bought as it is is called as its item, "hex-nut-m8" of "items/hex-nut-m8"; what is cut
// from stock, or of no item, as its part.
std::string ProductName(const parametric::EvaluatedPart& part) {
  const bool is_bought = !part.item.empty() && part.process == parametric::Process::kNone;
  return is_bought ? part.item.substr(part.item.find('/') + 1) : Stem(part.name);
}

// What products are told apart by.
struct Likeness {
  std::string item;
  std::string shape;                        // shapes/{digest}
  int round_about = kBox;                   // axis of the product
  std::vector<long> size;                   // nm, along the product's axes
  std::array<std::vector<long>, 3> levels;  // nm, along these, of the shape
  std::vector<double> color;
  auto operator<=>(const Likeness&) const = default;
};

// Makes products of parts, each at the origin and drawn along the axes of its shape or item, so
// that parts that are turned are of one.
class ProductMaker {
 public:
  ProductMaker(cad::StepAssembly& step, const DesignIdentity& identity)
      : step_(step), identity_(identity) {}

  // Adds a part, and its product if that is a new one.
  absl::Status Add(const parametric::EvaluatedPart& part, const mesh::DrawnShape* shape,
                   const mesh::BoxStretch& in_design, int group, const Eigen::Vector3d& color) {
    const ProductShapes::Turned drawn = shape == nullptr
                                            ? ProductShapes::Turned{nullptr, TurnOfItem(part)}
                                            : shapes_.Of(part.item, *shape, in_design);
    const Eigen::Matrix3d& turn = drawn.turn;
    const mesh::BoxStretch stretch = in_design.Turned(turn.transpose());
    const Eigen::Vector3d& size = stretch.size;
    Likeness likeness;
    likeness.item = part.item;
    if (drawn.shape != nullptr) {
      likeness.shape = drawn.shape->name;
    } else if (IsRound(part)) {
      turn.row(static_cast<int>(part.axis)).cwiseAbs().maxCoeff(&likeness.round_about);
    }
    for (const double length : size) likeness.size.push_back(std::lround(kAlike * length));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const mesh::LevelPlace& level : stretch.levels[axis]) {
        likeness.levels[axis].push_back(std::lround(kAlike * level.place));
      }
    }
    likeness.color.assign(color.begin(), color.end());
    const int round_about = likeness.round_about;
    const auto [known, is_new] =
        products_.try_emplace(std::move(likeness), static_cast<int>(step_.products.size()));
    cad::StepPart placed;
    placed.name = part.name;
    placed.group = group;
    placed.product = known->second;
    placed.placement.linear() = turn;
    // The box as it was before it was turned reached from the origin to this corner.
    placed.placement.translation() = part.minimum - (turn * size).cwiseMin(0);
    step_.parts.push_back(std::move(placed));
    if (!is_new) return absl::OkStatus();
    std::string name = ProductName(part);
    for (int number = 2; !names_.insert(name).second; ++number) {
      name = absl::StrCat(ProductName(part), " ", number);
    }
    MORTISE_ASSIGN_OR_RETURN(cad::Solid solid,
                             SolidOf(part, drawn.shape.get(), stretch, round_about, name));
    step_.products.push_back({std::move(name), std::move(solid), color});
    step_.products.back().identity = ProductIdentity(part, identity_);
    return absl::OkStatus();
  }

 private:
  cad::StepAssembly& step_;
  const DesignIdentity& identity_;
  ProductShapes shapes_;
  std::map<Likeness, int> products_;
  std::set<std::string> names_;
};

// Names in STEP have no control characters, which titles may have.
std::string InOneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  return text;
}

absl::StatusOr<parametric::Pose> PoseOf(const parametric::Assembly& assembly,
                                        const std::string& rest_pose) {
  std::string known;
  for (parametric::Pose& pose : parametric::PosesOf(assembly)) {
    if (pose.name == rest_pose) return std::move(pose);
    if (!pose.name.empty()) absl::StrAppend(&known, known.empty() ? "" : ", ", "'", pose.name, "'");
  }
  return InvalidField("rest_pose", absl::StrCat("there is no '", rest_pose, "'; the design ",
                                                known.empty() ? "has none" : "has " + known));
}

Eigen::Isometry3d MotionOf(const PosedAssembly& posed, const parametric::Pose& pose) {
  return parametric::MotionIn(pose, posed.assembly.assembly(), posed.assembly.elements().size(),
                              posed.q);
}

}  // namespace

absl::Status CheckRestPose(const parametric::Assembly& assembly, const std::string& rest_pose) {
  return PoseOf(assembly, rest_pose).status();
}

absl::StatusOr<std::string> ExportAssemblyStep(const PosedAssembly& posed,
                                               const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Pose pose,
                           PoseOf(posed.assembly.assembly(), posed.rest_pose));
  const parametric::ParametricAssembly& assembly = posed.assembly;
  cad::StepAssembly step;
  step.name = InOneLine(name);
  step.identity = posed.identity.whole;
  step.time_stamp = posed.identity.time_stamp;
  for (const parametric::AssemblyGroup& group : assembly.assembly().groups) {
    step.groups.push_back({group.name, group.parent});
  }
  if (pose.joint >= 0) {
    step.groups[static_cast<std::size_t>(pose.moved_group)].placement = MotionOf(posed, pose);
  }
  const std::vector<parametric::PlacedPart> placed = assembly.PartsAt(posed.q);
  const std::vector<Eigen::Vector3d> colors = PartColors(posed.design);
  ProductMaker products(step, posed.identity);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const int group = assembly.elements()[static_cast<std::size_t>(placed[i].element)].group;
    MORTISE_RETURN_IF_ERROR(products.Add(posed.design.parts[i], assembly.ShapeOf(placed[i]).get(),
                                         placed[i].stretch, group, colors[i]));
  }
  ShareNoIds(step.products);
  return cad::WriteStep(step);
}

absl::StatusOr<std::string> ExportAssemblyMesh(const PosedAssembly& posed, MeshFormat format,
                                               const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Pose pose,
                           PoseOf(posed.assembly.assembly(), posed.rest_pose));
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
