#include "services/simulator/service/evaluator_methods.h"

#include <utility>

#include "common/base/errors.h"
#include "common/host/call_author.h"
#include "services/simulator/service/evaluator_records.h"

namespace mortise::simulator::methods {

absl::StatusOr<v1::Evaluator> CreateEvaluator(const rpc::Call& call,
                                              const v1::CreateEvaluatorRequest& asked,
                                              store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(CheckEvaluator(asked.evaluator()));
  return simulator::CreateEvaluator(transaction, asked.evaluator(), rpc::AuthorOf(call));
}

absl::StatusOr<v1::Evaluator> GetEvaluator(store::Store& store, const rpc::Call&,
                                           const v1::GetEvaluatorRequest& asked) {
  return kEvaluators.Get(store, asked.name());
}

absl::StatusOr<v1::ListEvaluatorsResponse> ListEvaluators(store::Store& store, const rpc::Call&,
                                                          const v1::ListEvaluatorsRequest& asked) {
  const auto any = [](const v1::Evaluator&) { return true; };
  MORTISE_ASSIGN_OR_RETURN(auto page, kEvaluators.List(store, asked, any));
  return resources::ToResponse(std::move(page), &v1::ListEvaluatorsResponse::mutable_evaluators);
}

absl::StatusOr<v1::Evaluator> UpdateEvaluator(const rpc::Call& call,
                                              const v1::UpdateEvaluatorRequest& asked,
                                              store::Transaction& transaction) {
  return kEvaluators.UpdateTags(transaction, asked.evaluator(), asked.update_mask(), "evaluator",
                                rpc::AuthorOf(call));
}

absl::StatusOr<v1::DeleteEvaluatorResponse> DeleteEvaluator(const rpc::Call& call,
                                                            const v1::DeleteEvaluatorRequest& asked,
                                                            store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(
      simulator::DeleteEvaluator(transaction, asked.name(), rpc::AuthorOf(call)));
  return v1::DeleteEvaluatorResponse();
}

}  // namespace mortise::simulator::methods
