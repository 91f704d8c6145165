// Registered evaluators in the store, and what may be said about them.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/author.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::simulator {

// Records hold mortise.v1.Evaluator by the evaluator's id.
inline constexpr resources::Collection<v1::Evaluator> kEvaluators{
    .names = "evaluators", .kind = "evaluators", .event = "evaluator", .newest_first = false};

// Whether a subject or queue has the form of an evaluator's name: "evaluators/…".
bool IsEvaluatorName(const std::string& name);

// Fails with INVALID_ARGUMENT naming the field of the first fault,
// "evaluator.space.parameters[2].minimum", and those of all that is wrong with external ids and
// labels, "evaluator.labels".
absl::Status CheckEvaluator(const v1::Evaluator& evaluator);

// Writes a checked evaluator and tells of it ("evaluator.created"). One that is there and has the
// same content (title, version, design space) is given as it is, whatever external ids and labels
// either has: a worker that begins with it neither fails nor changes them. ALREADY_EXISTS if the
// content differs.
absl::StatusOr<v1::Evaluator> CreateEvaluator(store::Transaction& transaction,
                                              const v1::Evaluator& evaluator,
                                              const resources::Author& author);

// Removes it and cancels its unfinished tasks ("evaluator.deleted"). NOT_FOUND.
absl::Status DeleteEvaluator(store::Transaction& transaction, const std::string& name,
                             const resources::Author& author);

// Returns a digest of everything that results depend on: name, version and design space.
std::string EvaluatorDigest(const v1::Evaluator& evaluator);

}  // namespace mortise::simulator
