// Checks of an evaluated design: can it be cut from its items, and put together?
#include "common/design/design_checks.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "common/design/contact.h"
#include "common/design/design_evaluation.h"

namespace mortise::parametric {
namespace {

constexpr double kFixedSizeTolerance = 1e-5;  // m, between a part and a fixed dimension
constexpr double kRangeTolerance = 1e-9;      // m, beyond the range of a resizable dimension
constexpr std::size_t kMaxMeeting = 100;      // pairs of connections with pegs that meet
constexpr const char* kDimensionNames[] = {"length", "width", "thickness"};

// A part, and where the template says it.
struct PlacedPart {
  const CompiledPart* compiled;
  const EvaluatedPart* part;
};

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

// Pairs of parts of which the boxes overlap along x, so that not all have to be compared; in the
// order of the template.
std::vector<std::pair<std::size_t, std::size_t>> PairsToCompare(
    const std::vector<PlacedPart>& parts) {
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return parts[a].part->minimum.x() < parts[b].part->minimum.x();
  });
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double end = parts[order[i]].part->maximum.x() - kContactTolerance;
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (parts[order[j]].part->minimum.x() >= end) break;
      pairs.emplace_back(std::min(order[i], order[j]), std::max(order[i], order[j]));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void CheckPenetrations(const std::vector<PlacedPart>& parts,
                       std::vector<FieldViolation>& findings) {
  for (const auto& [i, j] : PairsToCompare(parts)) {
    const double depth = PenetrationDepth(*parts[i].part, *parts[j].part);
    if (depth <= kContactTolerance) continue;
    findings.push_back(
        {parts[j].compiled->field, absl::StrCat("'", parts[j].part->name, "' penetrates '",
                                                parts[i].part->name, "' by ", depth, " m")});
  }
}

void CheckPegInParts(const CompiledConnection& compiled, const JoinedPair& pair,
                     const EvaluatedConnector& peg, std::vector<FieldViolation>& findings) {
  const double radius = peg.diameter / 2;
  const double in_other = peg.length - peg.depth_in_part;
  if (!ContainsCylinder(*pair.part, peg.position, -peg.direction, peg.depth_in_part, radius)) {
    findings.push_back({compiled.field, absl::StrCat("a peg sticks out of '", peg.part, "'")});
  }
  if (!ContainsCylinder(*pair.other_part, peg.position, peg.direction, in_other, radius)) {
    findings.push_back(
        {compiled.field, absl::StrCat("a peg sticks out of '", peg.other_part, "'")});
  }
}

// Pegs, and of which connection each is.
struct PlacedPegs {
  std::vector<EvaluatedConnector> pegs;
  std::vector<std::size_t> connections;
};

void CheckPegsApart(const CompiledTemplate& compiled, const PlacedPegs& placed,
                    std::vector<FieldViolation>& findings) {
  std::set<std::pair<std::size_t, std::size_t>> meeting;  // connections
  ForNearPegs(placed.pegs, [&](std::size_t i, std::size_t j) {
    const std::pair connections(placed.connections[i], placed.connections[j]);
    if (meeting.contains(connections)) return true;
    if (PenetrationDepth(placed.pegs[i], placed.pegs[j]) > kContactTolerance) {
      meeting.insert(connections);
    }
    return meeting.size() < kMaxMeeting;
  });
  for (const auto& [one, other] : meeting) {
    findings.push_back({compiled.connections[other].field,
                        absl::StrCat("a peg meets a peg of '",
                                     compiled.bundle.definition.connections[one].name, "'")});
  }
}

void CheckPegs(const CompiledTemplate& compiled, const std::vector<PartCopies>& parts,
               const Eigen::VectorXd& q, std::vector<FieldViolation>& findings) {
  PlacedPegs placed;
  for (std::size_t i = 0; i < compiled.connections.size(); ++i) {
    const auto pairs = EvaluateConnection(compiled, i, parts, q);
    if (!pairs.ok()) {
      findings.push_back(FindingOf(pairs.status()));
      continue;
    }
    for (const JoinedPair& pair : *pairs) {
      for (const EvaluatedConnector& peg : pair.pegs) {
        CheckPegInParts(compiled.connections[i], pair, peg, findings);
        placed.pegs.push_back(peg);
        placed.connections.push_back(i);
      }
    }
    if (const absl::Status count = CheckPegCount(placed.pegs.size()); !count.ok()) {
      findings.push_back(FindingOf(count));
      return;
    }
  }
  CheckPegsApart(compiled, placed, findings);
}

// What is wrong with the numbers of conditions. Whether their parts are there, and their shares,
// is known only where all parts are.
void CheckConditions(const CompiledTemplate& compiled,
                     const std::vector<std::optional<PartCopies>>& parts,
                     const std::vector<PartCopies>& whole, const Eigen::VectorXd& q,
                     std::vector<FieldViolation>& findings) {
  for (std::size_t i = 0; i < compiled.conditions.size(); ++i) {
    absl::Status status;
    if (whole.size() == parts.size()) {
      status = EvaluateCondition(compiled, i, whole, q).status();
    } else if (const auto present = compiled.conditions.IsPresent(i, q); !present.ok()) {
      status = present.status();
    } else if (*present) {
      status = compiled.conditions.At(i, q).status();
    }
    if (!status.ok()) findings.push_back(FindingOf(status));
  }
  const auto reference = compiled.conditions.ReferenceTemperature(q);
  if (!reference.ok()) findings.push_back(FindingOf(reference.status()));
}

}  // namespace

std::vector<FieldViolation> CheckDesign(const CompiledTemplate& compiled,
                                        const Eigen::VectorXd& q) {
  std::vector<FieldViolation> findings;
  std::vector<std::optional<PartCopies>> parts(compiled.parts.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < compiled.parts.size(); ++i) {
    auto copies = EvaluatePart(compiled, i, q);
    if (!copies.ok()) {
      findings.push_back(FindingOf(copies.status()));
      continue;
    }
    for (const EvaluatedPart& part : copies->parts) {
      CheckSize(compiled.parts[i], part, *FindItem(compiled.bundle.items, part.item), findings);
    }
    count += copies->parts.size();
    parts[i] = *std::move(copies);
  }
  std::vector<PlacedPart> placed;
  std::vector<PartCopies> whole;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i]) continue;
    for (const EvaluatedPart& part : parts[i]->parts) placed.push_back({&compiled.parts[i], &part});
  }
  const bool is_whole =
      std::all_of(parts.begin(), parts.end(), [](const auto& part) { return part.has_value(); });
  if (const absl::Status enough = CheckPartCount(count); is_whole && !enough.ok()) {
    findings.push_back(FindingOf(enough));
    return findings;
  }
  CheckPenetrations(placed, findings);
  if (is_whole) {
    for (std::optional<PartCopies>& part : parts) whole.push_back(*std::move(part));
  }
  CheckConditions(compiled, parts, whole, q, findings);
  // Contacts mean something only between parts that have a shape.
  if (is_whole) CheckPegs(compiled, whole, q, findings);
  return findings;
}

}  // namespace mortise::parametric
