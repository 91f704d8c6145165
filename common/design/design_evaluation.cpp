// The pieces of F(q): parts, pegs, and volumes with gradients.
#include "common/design/design_evaluation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/contact.h"
#include "common/design/polygon.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;

constexpr double kMinEdge = 1e-6;  // m; outlines with shorter edges are refused

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

// Positions of the pegs of a row along its length, m. INVALID_ARGUMENT, "spacing", for more than
// kMaxRow.
absl::StatusOr<std::vector<double>> RowPositions(double length, double end_distance, double spacing,
                                                 double diameter) {
  const double between = length - 2 * end_distance;
  if (between < 2 * diameter) return std::vector<double>{length / 2};
  // A hair of tolerance keeps a row of exactly n spacings from getting one more peg by rounding.
  const double wanted = std::max(1.0, std::ceil(between / spacing - 1e-9));
  if (!(wanted < kMaxRow)) {
    return InvalidField(
        "spacing", absl::StrCat("makes more than ", kMaxRow, " pegs in a row of ", length, " m"));
  }
  const int gaps = static_cast<int>(wanted);
  std::vector<double> positions;
  for (int i = 0; i <= gaps; ++i) positions.push_back(end_distance + between * i / gaps);
  return positions;
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

}  // namespace

absl::StatusOr<EvaluatedPart> EvaluatePart(const CompiledTemplate& compiled_template,
                                           std::size_t index, const VectorXd& q) {
  const PartTemplate& definition = compiled_template.bundle.definition.parts[index];
  const CompiledPart& compiled = compiled_template.parts[index];
  EvaluatedPart part;
  part.name = definition.name;
  part.title = definition.title;
  part.item = definition.item;
  part.material = compiled.material;
  part.length_axis = definition.length_axis;
  part.thickness_axis = definition.thickness_axis;
  part.axis = compiled.axis;
  part.face_names = compiled.face_names;
  part.process = compiled.process;
  MORTISE_RETURN_IF_ERROR(FillNumbers(compiled, q, part));
  MORTISE_RETURN_IF_ERROR(CheckShape(compiled, std::holds_alternative<Box>(definition.body), part));
  FillExtents(definition, part);
  part.volume = SignedArea(part.outline) * (part.to - part.from);
  part.mass = part.volume * compiled.density;
  return part;
}

absl::StatusOr<std::vector<EvaluatedConnector>> EvaluateConnection(
    const CompiledTemplate& compiled_template, std::size_t index,
    const std::vector<EvaluatedPart>& parts) {
  const Connection& definition = compiled_template.bundle.definition.connections[index];
  const CompiledConnection& compiled = compiled_template.connections[index];
  const ContactPatch patch = FindContact(parts[compiled.part], static_cast<int>(compiled.face),
                                         parts[compiled.other_part]);
  if (patch.pieces.empty()) {
    return InvalidField(
        compiled.field,
        absl::StrCat("face '", definition.face, "' of '", definition.part, "' does not touch '",
                     definition.other_part, "' at these parameters"));
  }
  std::vector<EvaluatedConnector> pegs;
  const Eigen::Vector2d extent = patch.maximum - patch.minimum;
  const Eigen::Vector2d middle = (patch.minimum + patch.maximum) / 2;
  const int along = extent.x() >= extent.y() ? 0 : 1;
  const auto positions =
      RowPositions(extent(along), definition.end_distance, definition.spacing, compiled.diameter);
  if (!positions.ok()) return UnderField(compiled.field, positions.status());
  for (const double position : *positions) {
    Eigen::Vector2d point = middle;
    point(along) = patch.minimum(along) + position;
    EvaluatedConnector peg;
    peg.connection = definition.name;
    peg.item = definition.item;
    peg.part = definition.part;
    peg.other_part = definition.other_part;
    peg.position = patch.face.origin + point.x() * patch.face.u + point.y() * patch.face.v;
    peg.direction = patch.face.normal;
    peg.diameter = compiled.diameter;
    peg.length = compiled.length;
    peg.depth_in_part = definition.depth_in_part * compiled.length;
    peg.priority = definition.priority;
    pegs.push_back(std::move(peg));
  }
  return pegs;
}

absl::StatusOr<Dual> EvaluateVolume(const CompiledPart& part, const VectorXd& q) {
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

}  // namespace mortise::parametric
