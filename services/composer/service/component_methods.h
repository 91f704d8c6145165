// The methods that change what a model is made of. Each has a first step that does the work, and
// one that stores it. composer.proto says what each takes and gives; the wrappers of common/rpc
// what all have.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/mutation_log.h"
#include "common/store/store.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/model_change.h"

namespace mortise::composer::methods {

absl::StatusOr<ModelChange> AddComponent(const Composer& composer, const rpc::Call& call,
                                         const v1::AddComponentRequest& asked);

absl::StatusOr<ModelChange> SnapComponent(const Composer& composer, const rpc::Call& call,
                                          const v1::SnapComponentRequest& asked);

absl::StatusOr<ModelChange> ConnectComponent(const Composer& composer, const rpc::Call& call,
                                             const v1::ConnectComponentRequest& asked);

absl::StatusOr<ModelChange> MoveComponent(const Composer& composer, const rpc::Call& call,
                                          const v1::MoveComponentRequest& asked);

absl::StatusOr<ModelChange> RemoveNode(const Composer& composer, const rpc::Call& call,
                                       const v1::RemoveNodeRequest& asked);

// The second step of all of them. Where another change came between the two, what may be rebased
// goes through the first again.
template <typename Request>
absl::StatusOr<v1::Model> KeepChange(const Composer&, const rpc::Call& call, const Request& asked,
                                     ModelChange& change, store::Transaction& transaction) {
  absl::StatusOr<v1::Model> kept = StoreChange(transaction, change, call);
  if (absl::IsAborted(kept.status()) && MayRebase(asked)) return rpc::PrepareAgain(kept.status());
  return kept;
}

}  // namespace mortise::composer::methods
