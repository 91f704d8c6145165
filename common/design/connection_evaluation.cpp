// The pegs of connections: which copies are joined, and where pegs stand between two parts.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/contact.h"
#include "common/design/design_evaluation.h"
#include "common/design/polygon.h"

namespace mortise::parametric {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;
using Parts = std::vector<const EvaluatedPart*>;

// Positions of pegs along a line of the patch, m. INVALID_ARGUMENT naming `spacing_field` for more
// than kMaxRow.
absl::StatusOr<std::vector<double>> RowPositions(double length, double end_distance, double spacing,
                                                 double diameter, const char* spacing_field) {
  const double between = length - 2 * end_distance;
  if (between < 2 * diameter) return std::vector<double>{length / 2};
  // A hair of tolerance keeps a row of exactly n spacings from getting one more peg by rounding.
  const double wanted = std::max(1.0, std::ceil(between / spacing - 1e-9));
  if (!(wanted < kMaxRow)) {
    return InvalidField(spacing_field, absl::StrCat("makes more than ", kMaxRow,
                                                    " pegs in a row of ", length, " m"));
  }
  const int gaps = static_cast<int>(wanted);
  std::vector<double> positions;
  for (int i = 0; i <= gaps; ++i) positions.push_back(end_distance + between * i / gaps);
  return positions;
}

// Where pegs stand on a patch, row by row, m, in its (u, v).
absl::StatusOr<std::vector<Vector2d>> PegPositions(const Connection& definition,
                                                   const ContactPatch& patch, double diameter) {
  const Vector2d extent = patch.maximum - patch.minimum;
  const int along = extent.x() >= extent.y() ? 0 : 1;
  const int across = 1 - along;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<double> in_row,
                           RowPositions(extent(along), definition.end_distance, definition.spacing,
                                        diameter, "spacing"));
  std::vector<double> rows;
  if (definition.row_spacing > 0) {
    const double side =
        definition.side_distance > 0 ? definition.side_distance : definition.end_distance;
    MORTISE_ASSIGN_OR_RETURN(
        rows, RowPositions(extent(across), side, definition.row_spacing, diameter, "row_spacing"));
  }
  if (rows.size() * in_row.size() > kMaxPegs) {
    return InvalidField("row_spacing", absl::StrCat("makes ", rows.size(), " rows of ",
                                                    in_row.size(), " pegs, more than ", kMaxPegs));
  }
  std::vector<Vector2d> positions;
  const Vector2d middle = (patch.minimum + patch.maximum) / 2;
  for (std::size_t row = 0; row < std::max<std::size_t>(rows.size(), 1); ++row) {
    for (const double position : in_row) {
      Vector2d& point = positions.emplace_back(middle);
      point(along) = patch.minimum(along) + position;
      if (!rows.empty()) point(across) = patch.minimum(across) + rows[row];
    }
  }
  return positions;
}

class Joining {
 public:
  Joining(const Connection& definition, const CompiledConnection& compiled, const CompiledPeg& peg)
      : definition_(definition), compiled_(compiled), peg_(peg) {}

  // Adds the pegs between two parts, which must touch unless `may_be_apart`.
  absl::Status Join(const EvaluatedPart& part, const EvaluatedPart& other, bool may_be_apart) {
    const ContactPatch patch = FindContact(part, static_cast<int>(compiled_.face), other);
    if (patch.pieces.empty()) {
      if (may_be_apart) return absl::OkStatus();
      return InvalidField(compiled_.field,
                          absl::StrCat("face '", definition_.face, "' of '", part.name,
                                       "' does not touch '", other.name, "' at these parameters"));
    }
    const auto positions = PegPositions(definition_, patch, peg_.diameter);
    if (!positions.ok()) return UnderField(compiled_.field, positions.status());
    count_ += positions->size();
    if (count_ > kMaxPegs) {
      return InvalidField(compiled_.field, absl::StrCat("makes more than ", kMaxPegs, " pegs"));
    }
    JoinedPair& pair = pairs_.emplace_back(JoinedPair{&part, &other, {}});
    for (const Vector2d& point : *positions) {
      pair.pegs.push_back(PegAt(
          part, other, patch.face.origin + point.x() * patch.face.u + point.y() * patch.face.v,
          patch.face.normal));
    }
    return absl::OkStatus();
  }

  // Joins all copies that touch. Boxes tell of most pairs that they do not.
  absl::Status JoinTouching(const Parts& parts, const Parts& others) {
    for (const EvaluatedPart* const part : parts) {
      for (const EvaluatedPart* const other : others) {
        if (part == other || AreApart(*part, *other)) continue;
        MORTISE_RETURN_IF_ERROR(Join(*part, *other, true));
      }
    }
    if (!pairs_.empty()) return absl::OkStatus();
    return InvalidField(
        compiled_.field,
        absl::StrCat("face '", definition_.face, "' of no '", definition_.part, "' touches any '",
                     definition_.other_part, "' at these parameters"));
  }

  std::vector<JoinedPair> TakePairs() { return std::move(pairs_); }

 private:
  static bool AreApart(const EvaluatedPart& a, const EvaluatedPart& b) {
    const Eigen::Vector3d gap = a.minimum.cwiseMax(b.minimum) - a.maximum.cwiseMin(b.maximum);
    return gap.maxCoeff() > kContactTolerance;
  }

  EvaluatedConnector PegAt(const EvaluatedPart& part, const EvaluatedPart& other,
                           const Eigen::Vector3d& position, const Eigen::Vector3d& direction) {
    EvaluatedConnector peg;
    peg.connection = definition_.name;
    peg.item = peg_.item;
    peg.part = part.name;
    peg.other_part = other.name;
    peg.position = position;
    peg.direction = direction;
    peg.diameter = peg_.diameter;
    peg.length = peg_.length;
    peg.depth_in_part = definition_.depth_in_part * peg_.length;
    peg.priority = definition_.priority;
    return peg;
  }

  const Connection& definition_;
  const CompiledConnection& compiled_;
  const CompiledPeg& peg_;
  std::vector<JoinedPair> pairs_;
  std::size_t count_ = 0;
};

absl::Status JoinByNumber(const Connection& definition, const std::string& field,
                          const Parts& parts, const Parts& others, Joining& joining) {
  if (parts.size() != others.size()) {
    return InvalidField(
        absl::StrCat(field, ".pairing"),
        absl::StrCat("'", definition.part, "' is there ", parts.size(), " times and '",
                     definition.other_part, "' ", others.size(),
                     " times: joined by number, there must be as many of both; TOUCHING joins "
                     "those that touch"));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(joining.Join(*parts[i], *others[i], false));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<JoinedPair>> EvaluateConnection(
    const CompiledTemplate& compiled_template, std::size_t index,
    const std::vector<PartCopies>& parts, const VectorXd& q) {
  const Connection& definition = compiled_template.bundle.definition.connections[index];
  const CompiledConnection& compiled = compiled_template.connections[index];
  MORTISE_ASSIGN_OR_RETURN(const bool is_present, HoldsAt(compiled.present, q));
  if (!is_present) return std::vector<JoinedPair>();
  MORTISE_ASSIGN_OR_RETURN(const Parts own, CopiesOf(compiled_template, compiled.part, parts,
                                                     absl::StrCat(compiled.field, ".part")));
  MORTISE_ASSIGN_OR_RETURN(const Parts others,
                           CopiesOf(compiled_template, compiled.other_part, parts,
                                    absl::StrCat(compiled.field, ".other_part")));
  MORTISE_ASSIGN_OR_RETURN(const CompiledPeg* const peg, compiled.peg.At(q));
  Joining joining(definition, compiled, *peg);
  const auto is_many = [&](const CompiledReference& reference) {
    return reference.copy.empty() && !compiled_template.parts[reference.part].repeat.empty();
  };
  if (definition.pairing == Pairing::kTouching) {
    MORTISE_RETURN_IF_ERROR(joining.JoinTouching(own, others));
  } else if (is_many(compiled.part) && is_many(compiled.other_part)) {
    MORTISE_RETURN_IF_ERROR(JoinByNumber(definition, compiled.field, own, others, joining));
  } else {
    for (const EvaluatedPart* const part : own) {
      for (const EvaluatedPart* const other : others) {
        MORTISE_RETURN_IF_ERROR(joining.Join(*part, *other, false));
      }
    }
  }
  return joining.TakePairs();
}

absl::StatusOr<std::optional<std::vector<EvaluatedBoundaryCondition>>> EvaluateCondition(
    const CompiledTemplate& compiled, std::size_t index, const std::vector<PartCopies>& parts,
    const VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const bool is_present, compiled.conditions.IsPresent(index, q));
  if (!is_present) return std::nullopt;
  MORTISE_ASSIGN_OR_RETURN(const EvaluatedBoundaryCondition condition,
                           compiled.conditions.At(index, q));
  const std::optional<CompiledPlace>& place = compiled.places[index];
  if (!place) return std::vector<EvaluatedBoundaryCondition>{condition};
  MORTISE_ASSIGN_OR_RETURN(const Parts copies,
                           CopiesOf(compiled, place->part, parts,
                                    absl::StrCat("boundary_conditions[", index, "].part")));
  std::vector<EvaluatedBoundaryCondition> conditions;
  std::vector<double> areas;
  double area = 0;
  for (const EvaluatedPart* const copy : copies) {
    conditions.push_back(condition);
    conditions.back().part = copy->name;
    areas.push_back(SignedArea(FaceOf(*copy, static_cast<int>(place->face)).polygon));
    area += areas.back();
  }
  if (copies.size() > 1 && condition.kind == BoundaryConditionKind::kForce) {
    for (std::size_t i = 0; i < copies.size(); ++i) conditions[i].force *= areas[i] / area;
  }
  return conditions;
}

}  // namespace mortise::parametric
