// The pieces of F(q): parts, pegs, and volumes with gradients.
#include "common/design/design_evaluation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/design/polygon.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;

constexpr double kMinEdge = 1e-6;         // m; outlines with shorter edges are refused
constexpr double kWholeTolerance = 1e-6;  // of a count, which may be the quotient of lengths

absl::StatusOr<double> ValueOf(const PlacedExpression& placed, const VectorXd& q) {
  absl::StatusOr<double> value = placed.expression.Value(q);
  if (!value.ok()) return InvalidField(placed.field, std::string(value.status().message()));
  return value;
}

absl::StatusOr<Dual> DualOf(const PlacedExpression& placed, const VectorXd& q) {
  absl::StatusOr<Dual> value = placed.expression.ValueAndGradient(q);
  if (!value.ok()) return InvalidField(placed.field, std::string(value.status().message()));
  return value;
}

// The outline field of a part, to be named where its shape is wrong.
std::string OutlineField(const CompiledPart& compiled, bool is_box) {
  return absl::StrCat(compiled.field, is_box ? ".box" : ".prism.outline");
}

absl::Status CheckBox(const CompiledPart& compiled, const Eigen::Matrix2Xd& outline) {
  if (!(outline(0, 1) - outline(0, 0) > kMinEdge)) {
    return InvalidField(absl::StrCat(compiled.field, ".box.x"), "'to' is not greater than 'from'");
  }
  if (!(outline(1, 2) - outline(1, 1) > kMinEdge)) {
    return InvalidField(absl::StrCat(compiled.field, ".box.y"), "'to' is not greater than 'from'");
  }
  return absl::OkStatus();
}

absl::Status CheckShape(const CompiledPart& compiled, bool is_box, const EvaluatedPart& part) {
  if (!(part.to - part.from > kMinEdge)) {
    return InvalidField(
        absl::StrCat(compiled.field, is_box ? ".box.z" : ".prism.extent"),
        absl::StrCat("'to' (", part.to, ") is not greater than 'from' (", part.from, ")"));
  }
  if (is_box) return CheckBox(compiled, part.outline);
  if (!IsSimple(part.outline, kMinEdge)) {
    return InvalidField(OutlineField(compiled, is_box),
                        "is not a simple polygon of at least three distinct corners");
  }
  if (SignedArea(part.outline) <= 0) {
    return InvalidField(OutlineField(compiled, is_box), "does not run counter-clockwise");
  }
  return absl::OkStatus();
}

absl::Status FillNumbers(const CompiledPart& compiled, const VectorXd& q, EvaluatedPart& part) {
  std::vector<double> u, v;
  for (const PlacedExpression& expression : compiled.u) {
    MORTISE_ASSIGN_OR_RETURN(const double value, ValueOf(expression, q));
    u.push_back(value);
  }
  for (const PlacedExpression& expression : compiled.v) {
    MORTISE_ASSIGN_OR_RETURN(const double value, ValueOf(expression, q));
    v.push_back(value);
  }
  part.outline.resize(2, static_cast<Eigen::Index>(compiled.u_of_corner.size()));
  for (std::size_t i = 0; i < compiled.u_of_corner.size(); ++i) {
    part.outline.col(static_cast<Eigen::Index>(i))
        << u[static_cast<std::size_t>(compiled.u_of_corner[i])],
        v[static_cast<std::size_t>(compiled.v_of_corner[i])];
  }
  MORTISE_ASSIGN_OR_RETURN(part.from, ValueOf(compiled.from, q));
  MORTISE_ASSIGN_OR_RETURN(part.to, ValueOf(compiled.to, q));
  return absl::OkStatus();
}

// The bounding box, and its sizes along the axes of the item.
void FillExtents(const PartTemplate& definition, EvaluatedPart& part) {
  const Eigen::Vector2d low = part.outline.rowwise().minCoeff();
  const Eigen::Vector2d high = part.outline.rowwise().maxCoeff();
  part.minimum = FromPrismAxes(part.axis, low.x(), low.y(), part.from);
  part.maximum = FromPrismAxes(part.axis, high.x(), high.y(), part.to);
  const Eigen::Vector3d extents = part.maximum - part.minimum;
  const int length = static_cast<int>(definition.length_axis);
  const int thickness = static_cast<int>(definition.thickness_axis);
  const int width = 3 - length - thickness;
  part.size = {extents(length), extents(width), extents(thickness)};
}

// ---- Mass with gradients: the same sums over numbers that carry derivatives
// ----------------------

Dual Minus(const Dual& a, const Dual& b) { return {a.value - b.value, a.gradient - b.gradient}; }

Dual Times(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.gradient * b.value + b.gradient * a.value};
}

void Accumulate(Dual& sum, const Dual& term, double factor) {
  sum.value += factor * term.value;
  sum.gradient += factor * term.gradient;
}

// How many copies there are along each direction.
absl::StatusOr<std::vector<int>> CountCopies(const CompiledPart& compiled, const VectorXd& q) {
  std::vector<int> numbers;
  std::size_t copies = 1;
  for (const CompiledRepeat& repeat : compiled.repeat) {
    MORTISE_ASSIGN_OR_RETURN(const double count, ValueOf(repeat.count, q));
    const double whole = std::round(count);
    if (std::abs(count - whole) > kWholeTolerance) {
      return InvalidField(repeat.count.field,
                          absl::StrCat("is ", count, ", no whole number: floor and ceil make one"));
    }
    if (!(whole >= 1 && whole <= kMaxCopies)) {
      return InvalidField(
          repeat.count.field,
          absl::StrCat("is ", whole, ", but must be 1 to ", kMaxCopies,
                       whole == 0 ? ": 'present' says when there is none of a part" : ""));
    }
    numbers.push_back(static_cast<int>(whole));
    copies *= static_cast<std::size_t>(whole);
  }
  if (copies > kMaxParts) {
    return InvalidField(absl::StrCat(compiled.field, ".repeat"),
                        absl::StrCat("makes ", copies, " parts; a design has at most ", kMaxParts));
  }
  return numbers;
}

// How far the copies of each direction lie apart.
absl::StatusOr<std::vector<Eigen::Vector3d>> StepsOf(const CompiledPart& compiled,
                                                     const VectorXd& q) {
  std::vector<Eigen::Vector3d> steps;
  for (const CompiledRepeat& repeat : compiled.repeat) {
    Eigen::Vector3d& step = steps.emplace_back(Eigen::Vector3d::Zero());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!repeat.step[axis]) continue;
      MORTISE_ASSIGN_OR_RETURN(step(static_cast<Eigen::Index>(axis)),
                               ValueOf(*repeat.step[axis], q));
    }
  }
  return steps;
}

// What the body's expressions take: the parameters, then the numbers of a copy from 0, along those
// directions that have an index.
VectorXd WithIndices(const CompiledPart& compiled, const VectorXd& q,
                     const std::vector<int>& copy) {
  VectorXd values = q;
  for (std::size_t d = 0; d < compiled.repeat.size(); ++d) {
    if (!compiled.repeat[d].has_index) continue;
    values.conservativeResize(values.size() + 1);
    values(values.size() - 1) = copy[d];
  }
  return values;
}

// The next numbers of a copy, counted from 0; the last direction counts first.
void Advance(const std::vector<int>& numbers, std::vector<int>& copy) {
  for (std::size_t d = numbers.size(); d-- > 0;) {
    if (++copy[d] < numbers[d]) return;
    copy[d] = 0;
  }
}

void Move(const Eigen::Vector3d& by, EvaluatedPart& part) {
  const Eigen::Vector3d u = FromPrismAxes(part.axis, 1, 0, 0);
  const Eigen::Vector3d v = FromPrismAxes(part.axis, 0, 1, 0);
  const double along = FromPrismAxes(part.axis, 0, 0, 1).dot(by);
  part.outline.colwise() += Eigen::Vector2d(u.dot(by), v.dot(by));
  part.from += along;
  part.to += along;
}

// What all copies have in common.
EvaluatedPart WithoutShape(const PartTemplate& definition, const CompiledPart& compiled,
                           const CompiledItem& item) {
  EvaluatedPart part;
  part.name = definition.name;
  part.title = definition.title;
  part.item = item.item;
  part.material = item.material;
  part.length_axis = definition.length_axis;
  part.thickness_axis = definition.thickness_axis;
  part.axis = compiled.axis;
  part.face_names = compiled.face_names;
  part.process = item.process;
  return part;
}

// Fills in everything that follows from outline and extents.
void FillMeasures(const PartTemplate& definition, const CompiledItem& item, EvaluatedPart& part) {
  FillExtents(definition, part);
  part.volume = SignedArea(part.outline) * (part.to - part.from);
  part.mass = part.volume * item.density;
}

// The copies of a part that is repeated. Those without an index are alike but for their place.
absl::Status EvaluateCopies(const PartTemplate& definition, const CompiledPart& compiled,
                            const CompiledItem& item, const VectorXd& q, PartCopies& copies) {
  const bool is_box = std::holds_alternative<Box>(definition.body);
  const bool has_index = compiled.HasIndex();
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::Vector3d> steps, StepsOf(compiled, q));
  EvaluatedPart first = WithoutShape(definition, compiled, item);
  if (!has_index) {
    MORTISE_RETURN_IF_ERROR(FillNumbers(compiled, q, first));
    MORTISE_RETURN_IF_ERROR(CheckShape(compiled, is_box, first));
  }
  std::size_t count = 1;
  for (const int number : copies.numbers) count *= static_cast<std::size_t>(number);
  std::vector<int> copy(copies.numbers.size(), 0);
  for (std::size_t k = 0; k < count; ++k, Advance(copies.numbers, copy)) {
    EvaluatedPart& part = copies.parts.emplace_back(first);
    std::vector<int> numbers = copy;
    for (int& number : numbers) ++number;
    part.name = CopyName(definition.name, numbers);
    if (has_index) {
      MORTISE_RETURN_IF_ERROR(FillNumbers(compiled, WithIndices(compiled, q, copy), part));
      MORTISE_RETURN_IF_ERROR(CheckShape(compiled, is_box, part));
    }
    Eigen::Vector3d by = Eigen::Vector3d::Zero();
    for (std::size_t d = 0; d < copy.size(); ++d) by += copy[d] * steps[d];
    Move(by, part);
    FillMeasures(definition, item, part);
  }
  return absl::OkStatus();
}

// The volume of a body.
absl::StatusOr<Dual> VolumeOf(const CompiledPart& part, const VectorXd& q) {
  std::vector<Dual> u, v;
  for (const PlacedExpression& expression : part.u) {
    MORTISE_ASSIGN_OR_RETURN(Dual value, DualOf(expression, q));
    u.push_back(std::move(value));
  }
  for (const PlacedExpression& expression : part.v) {
    MORTISE_ASSIGN_OR_RETURN(Dual value, DualOf(expression, q));
    v.push_back(std::move(value));
  }
  Dual area{0, VectorXd::Zero(q.size())};
  const std::size_t count = part.u_of_corner.size();
  const auto corner_u = [&](std::size_t i) -> const Dual& {
    return u[static_cast<std::size_t>(part.u_of_corner[i % count])];
  };
  const auto corner_v = [&](std::size_t i) -> const Dual& {
    return v[static_cast<std::size_t>(part.v_of_corner[i % count])];
  };
  for (std::size_t i = 0; i < count; ++i) {
    Accumulate(area, Times(corner_u(i), corner_v(i + 1)), 0.5);
    Accumulate(area, Times(corner_u(i + 1), corner_v(i)), -0.5);
  }
  MORTISE_ASSIGN_OR_RETURN(const Dual from, DualOf(part.from, q));
  MORTISE_ASSIGN_OR_RETURN(const Dual to, DualOf(part.to, q));
  return Times(area, Minus(to, from));
}

}  // namespace

absl::Status CheckPartCount(std::size_t parts) {
  if (parts == 0) return InvalidField("parts", "are all absent at these parameters");
  if (parts <= kMaxParts) return absl::OkStatus();
  return InvalidField("parts", absl::StrCat("are ", parts, "; a design has at most ", kMaxParts));
}

absl::Status CheckPegCount(std::size_t pegs) {
  if (pegs <= kMaxPegs) return absl::OkStatus();
  return InvalidField("connections", absl::StrCat("make more than ", kMaxPegs, " pegs"));
}

absl::StatusOr<PartCopies> EvaluatePart(const CompiledTemplate& compiled_template,
                                        std::size_t index, const VectorXd& q) {
  const PartTemplate& definition = compiled_template.bundle.definition.parts[index];
  const CompiledPart& compiled = compiled_template.parts[index];
  PartCopies copies;
  MORTISE_ASSIGN_OR_RETURN(copies.is_present, HoldsAt(compiled.present, q));
  if (!copies.is_present) return copies;
  MORTISE_ASSIGN_OR_RETURN(const CompiledItem* const item, compiled.item.At(q));
  copies.item = item->item;
  if (!compiled.repeat.empty()) {
    MORTISE_ASSIGN_OR_RETURN(copies.numbers, CountCopies(compiled, q));
    MORTISE_RETURN_IF_ERROR(EvaluateCopies(definition, compiled, *item, q, copies));
    return copies;
  }
  EvaluatedPart& part = copies.parts.emplace_back(WithoutShape(definition, compiled, *item));
  MORTISE_RETURN_IF_ERROR(FillNumbers(compiled, q, part));
  MORTISE_RETURN_IF_ERROR(CheckShape(compiled, std::holds_alternative<Box>(definition.body), part));
  FillMeasures(definition, *item, part);
  return copies;
}

absl::StatusOr<PartMass> EvaluateMassOf(const CompiledPart& part, const VectorXd& q) {
  PartMass mass{{0, VectorXd::Zero(q.size())}, 0};
  MORTISE_ASSIGN_OR_RETURN(const bool is_present, HoldsAt(part.present, q));
  if (!is_present) return mass;
  MORTISE_ASSIGN_OR_RETURN(const CompiledItem* const item, part.item.At(q));
  mass.density = item->density;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<int> numbers, CountCopies(part, q));
  int count = 1;
  for (const int number : numbers) count *= number;
  if (!part.HasIndex()) {
    MORTISE_ASSIGN_OR_RETURN(const Dual volume, VolumeOf(part, q));
    Accumulate(mass.volume, volume, count);
    return mass;
  }
  std::vector<int> copy(numbers.size(), 0);
  for (int k = 0; k < count; ++k, Advance(numbers, copy)) {
    MORTISE_ASSIGN_OR_RETURN(Dual volume, VolumeOf(part, WithIndices(part, q, copy)));
    volume.gradient.conservativeResize(q.size());  // a copy's number is no parameter
    Accumulate(mass.volume, volume, 1);
  }
  return mass;
}

absl::StatusOr<std::vector<const EvaluatedPart*>> CopiesOf(const CompiledTemplate& compiled,
                                                           const CompiledReference& reference,
                                                           const std::vector<PartCopies>& parts,
                                                           const std::string& field) {
  const std::string& name = compiled.bundle.definition.parts[reference.part].name;
  const PartCopies& copies = parts[reference.part];
  if (!copies.is_present) {
    return InvalidField(field, absl::StrCat("'", name,
                                            "' is absent where this is present: say "
                                            "when it is by 'present'"));
  }
  std::vector<const EvaluatedPart*> meant;
  const std::string wanted = reference.copy.empty() ? "" : CopyName(name, reference.copy);
  for (const EvaluatedPart& part : copies.parts) {
    if (wanted.empty() || part.name == wanted) meant.push_back(&part);
  }
  if (!meant.empty()) return meant;
  return InvalidField(field, absl::StrCat("there is no '", wanted, "': '", name, "' is there ",
                                          absl::StrJoin(copies.numbers, " × "), " times"));
}

}  // namespace mortise::parametric
