// The methods of EvaluatorService about registered evaluators.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::simulator::methods {

absl::StatusOr<v1::Evaluator> CreateEvaluator(const rpc::Call& call,
                                              const v1::CreateEvaluatorRequest& asked,
                                              store::Transaction& transaction);

absl::StatusOr<v1::Evaluator> GetEvaluator(store::Store& store, const rpc::Call& call,
                                           const v1::GetEvaluatorRequest& asked);

absl::StatusOr<v1::ListEvaluatorsResponse> ListEvaluators(store::Store& store,
                                                          const rpc::Call& call,
                                                          const v1::ListEvaluatorsRequest& asked);

absl::StatusOr<v1::Evaluator> UpdateEvaluator(const rpc::Call& call,
                                              const v1::UpdateEvaluatorRequest& asked,
                                              store::Transaction& transaction);

absl::StatusOr<v1::DeleteEvaluatorResponse> DeleteEvaluator(const rpc::Call& call,
                                                            const v1::DeleteEvaluatorRequest& asked,
                                                            store::Transaction& transaction);

}  // namespace mortise::simulator::methods
