// Evaluates the pieces of a compiled template one by one, so that a check can go on after a piece
// that fails. Private to this folder; evaluation.h is the door.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/compiled_template.h"
#include "common/design/evaluated_design.h"

namespace mortise::parametric {

inline constexpr int kMaxCopies = 1000;          // of a part along a direction
inline constexpr std::size_t kMaxParts = 2000;   // of a design, copies and all
inline constexpr int kMaxRow = 1000;             // pegs in a row
inline constexpr std::size_t kMaxPegs = 10'000;  // of a design

// Whether a design may have so many parts, at least one, or pegs; INVALID_ARGUMENT naming "parts"
// or "connections".
absl::Status CheckPartCount(std::size_t parts);
absl::Status CheckPegCount(std::size_t pegs);

// What there is of a part of the template.
struct PartCopies {
  bool is_present = true;
  std::vector<int> numbers;          // how many along each direction; none of what is not repeated
  std::string item = {};             // items/{id} that it is made of
  std::vector<EvaluatedPart> parts;  // one of what is not repeated; else by number
};

// Returns what there is of the part of this index; an absent one costs nothing. INVALID_ARGUMENT
// naming the expression that fails, the count that is none, or the extent or outline that is no
// shape.
absl::StatusOr<PartCopies> EvaluatePart(const CompiledTemplate& compiled, std::size_t part,
                                        const Eigen::VectorXd& q);

// The pegs between two parts.
struct JoinedPair {
  const EvaluatedPart* part = nullptr;
  const EvaluatedPart* other_part = nullptr;
  std::vector<EvaluatedConnector> pegs;
};

// Returns the pegs of the connection of this index, for all parts of the template already
// evaluated; none where the connection is absent. INVALID_ARGUMENT naming the connection where one
// of its parts is absent or its parts do not touch, "pairing" where copies are not as many, or its
// spacing if that makes more than kMaxRow in a row or kMaxPegs in all.
absl::StatusOr<std::vector<JoinedPair>> EvaluateConnection(const CompiledTemplate& compiled,
                                                           std::size_t connection,
                                                           const std::vector<PartCopies>& parts,
                                                           const Eigen::VectorXd& q);

// Returns the boundary condition of this index on each copy that it acts on, for all parts of the
// template already evaluated; nothing where it is absent. Copies share a force by the areas of
// their faces. INVALID_ARGUMENT naming the component that fails, or its part where that is absent.
absl::StatusOr<std::optional<std::vector<EvaluatedBoundaryCondition>>> EvaluateCondition(
    const CompiledTemplate& compiled, std::size_t condition, const std::vector<PartCopies>& parts,
    const Eigen::VectorXd& q);

// Returns volume and mass of all copies of the part of this index, m³ and kg, with their gradients.
struct PartMass {
  Dual volume;
  double density = 0;  // kg/m³
};
absl::StatusOr<PartMass> EvaluateMassOf(const CompiledPart& part, const Eigen::VectorXd& q);

// Returns the copies that are meant, one or all of them. INVALID_ARGUMENT naming `field` where the
// part is absent, or there are not so many copies.
absl::StatusOr<std::vector<const EvaluatedPart*>> CopiesOf(const CompiledTemplate& compiled,
                                                           const CompiledReference& reference,
                                                           const std::vector<PartCopies>& parts,
                                                           const std::string& field);

}  // namespace mortise::parametric
