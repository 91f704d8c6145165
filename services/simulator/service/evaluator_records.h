// Registered evaluators in the store, and what may be said about them.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::simulator {

// Whether a subject or queue has the form of an evaluator's name: "evaluators/…".
bool IsEvaluatorName(const std::string& name);

// INVALID_ARGUMENT naming the field, "evaluator.space.parameters[2].minimum", of the first fault.
absl::Status CheckEvaluator(const v1::Evaluator& evaluator);

// Writes a checked evaluator and tells of it ("evaluator.created"). One that is there and says the
// same is given as it is; ALREADY_EXISTS if it differs.
absl::StatusOr<v1::Evaluator> CreateEvaluator(store::Transaction& transaction,
                                              const v1::Evaluator& evaluator,
                                              const std::string& trace_id);

// NOT_FOUND; INVALID_ARGUMENT naming `field`.
absl::StatusOr<v1::Evaluator> GetEvaluator(store::ReadTransaction& transaction,
                                           const std::string& name, const std::string& field);

// By name. INVALID_ARGUMENT naming page_size or page_token.
absl::StatusOr<v1::ListEvaluatorsResponse> ListEvaluators(store::ReadTransaction& transaction,
                                                          const v1::ListEvaluatorsRequest& asked);

// Removes it and cancels its unfinished tasks ("evaluator.deleted"). NOT_FOUND.
absl::Status DeleteEvaluator(store::Transaction& transaction, const std::string& name,
                             const std::string& trace_id);

// A digest of everything that results depend on: name, version and design space.
std::string EvaluatorDigest(const v1::Evaluator& evaluator);

}  // namespace mortise::simulator
