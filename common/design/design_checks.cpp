// Checks of an evaluated design: can it be cut from its items, and put together?
#include "common/design/design_checks.h"

#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "common/design/contact.h"
#include "common/design/design_evaluation.h"

namespace mortise::parametric {
namespace {

constexpr double kFixedSizeTolerance = 1e-5;  // m, between a part and a fixed dimension
constexpr double kRangeTolerance = 1e-9;      // m, beyond the range of a resizable dimension
constexpr std::size_t kMaxPegs = 1000;        // of a design; each is compared with all others
constexpr const char* kDimensionNames[] = {"length", "width", "thickness"};

// Splits a field's status back into a finding: the message begins with the field.
FieldViolation FindingOf(const absl::Status& status) {
  const std::string field = DetailOf(status).field;
  std::string message(status.message());
  if (message.rfind(field + ": ", 0) == 0) message = message.substr(field.size() + 2);
  return {field, message};
}

void CheckSize(const CompiledPart& compiled, const EvaluatedPart& part, const Item& item,
               std::vector<FieldViolation>& findings) {
  for (int i = 0; i < 3; ++i) {
    const ItemDimension& dimension = item.dimensions[static_cast<std::size_t>(i)];
    const double size = part.size(i);
    const bool fixed = dimension.process == Process::kNone;
    const double minimum =
        fixed ? dimension.size - kFixedSizeTolerance : dimension.minimum - kRangeTolerance;
    const double maximum =
        fixed ? dimension.size + kFixedSizeTolerance : dimension.maximum + kRangeTolerance;
    if (size >= minimum && size <= maximum) continue;
    const std::vector<std::string> texts =
        fixed ? ComparedNumbers({size, dimension.size})
              : ComparedNumbers({size, dimension.minimum, dimension.maximum});
    const std::string allowed =
        fixed ? absl::StrCat("is sold only with ", texts[1], " m")
              : absl::StrCat("can be made from ", texts[1], " to ", texts[2], " m");
    findings.push_back({absl::StrCat(compiled.field, ".item"),
                        absl::StrCat("the ", kDimensionNames[i], " of '", part.name, "' is ",
                                     texts[0], " m, but '", item.name, "' ", allowed)});
  }
}

void CheckPenetrations(const CompiledTemplate& compiled,
                       const std::vector<std::optional<EvaluatedPart>>& parts,
                       std::vector<FieldViolation>& findings) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      if (!parts[i] || !parts[j]) continue;
      const double depth = PenetrationDepth(*parts[i], *parts[j]);
      if (depth <= kContactTolerance) continue;
      findings.push_back(
          {compiled.parts[j].field, absl::StrCat("'", parts[j]->name, "' penetrates '",
                                                 parts[i]->name, "' by ", depth, " m")});
    }
  }
}

void CheckPegInParts(const CompiledConnection& compiled, const EvaluatedConnector& peg,
                     const std::vector<EvaluatedPart>& parts,
                     std::vector<FieldViolation>& findings) {
  const double radius = peg.diameter / 2;
  const double in_other = peg.length - peg.depth_in_part;
  if (!ContainsCylinder(parts[compiled.part], peg.position, -peg.direction, peg.depth_in_part,
                        radius)) {
    findings.push_back({compiled.field, absl::StrCat("a peg sticks out of '", peg.part, "'")});
  }
  if (!ContainsCylinder(parts[compiled.other_part], peg.position, peg.direction, in_other,
                        radius)) {
    findings.push_back(
        {compiled.field, absl::StrCat("a peg sticks out of '", peg.other_part, "'")});
  }
}

void CheckPegs(const CompiledTemplate& compiled, const std::vector<EvaluatedPart>& parts,
               std::vector<FieldViolation>& findings) {
  struct PlacedPeg {
    EvaluatedConnector peg;
    std::size_t connection;
  };
  std::vector<PlacedPeg> all;
  for (std::size_t i = 0; i < compiled.connections.size(); ++i) {
    const auto pegs = EvaluateConnection(compiled, i, parts);
    if (!pegs.ok()) {
      findings.push_back(FindingOf(pegs.status()));
      continue;
    }
    if (all.size() + pegs->size() > kMaxPegs) {
      findings.push_back({"connections", absl::StrCat("make more than ", kMaxPegs, " pegs")});
      return;
    }
    for (const EvaluatedConnector& peg : *pegs) {
      CheckPegInParts(compiled.connections[i], peg, parts, findings);
      all.push_back({peg, i});
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (PenetrationDepth(all[i].peg, all[j].peg) <= kContactTolerance) continue;
      findings.push_back({compiled.connections[all[j].connection].field,
                          absl::StrCat("a peg meets a peg of '", all[i].peg.connection, "'")});
    }
  }
}

}  // namespace

std::vector<FieldViolation> CheckDesign(const CompiledTemplate& compiled,
                                        const Eigen::VectorXd& q) {
  std::vector<FieldViolation> findings;
  std::vector<std::optional<EvaluatedPart>> parts(compiled.parts.size());
  std::vector<EvaluatedPart> whole;
  for (std::size_t i = 0; i < compiled.parts.size(); ++i) {
    auto part = EvaluatePart(compiled, i, q);
    if (!part.ok()) {
      findings.push_back(FindingOf(part.status()));
      continue;
    }
    CheckSize(compiled.parts[i], *part, *FindItem(compiled.bundle.items, part->item), findings);
    parts[i] = *part;
    whole.push_back(*std::move(part));
  }
  CheckPenetrations(compiled, parts, findings);
  for (std::size_t i = 0; i < compiled.conditions.size(); ++i) {
    const auto condition = compiled.conditions.At(i, q);
    if (!condition.ok()) findings.push_back(FindingOf(condition.status()));
  }
  const auto reference = compiled.conditions.ReferenceTemperature(q);
  if (!reference.ok()) findings.push_back(FindingOf(reference.status()));
  // Contacts mean something only between parts that have a shape.
  if (whole.size() == parts.size()) CheckPegs(compiled, whole, findings);
  return findings;
}

}  // namespace mortise::parametric
