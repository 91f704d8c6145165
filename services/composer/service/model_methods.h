// The methods of models as a whole: made, read, listed, forked, removed, undone. composer.proto
// says what each takes and gives; the wrappers of common/rpc what all have.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/composer.h"

namespace mortise::composer::methods {

absl::StatusOr<v1::Model> CreateModel(const Composer& composer, const rpc::Call& call,
                                      const v1::CreateModelRequest& asked,
                                      store::Transaction& transaction);

absl::StatusOr<v1::Model> GetModel(const Composer& composer, const rpc::Call& call,
                                   const v1::GetModelRequest& asked);

absl::StatusOr<v1::ListModelsResponse> ListModels(const Composer& composer, const rpc::Call& call,
                                                  const v1::ListModelsRequest& asked);

absl::StatusOr<v1::Model> UpdateModel(const Composer& composer, const rpc::Call& call,
                                      const v1::UpdateModelRequest& asked,
                                      store::Transaction& transaction);

absl::StatusOr<v1::DeleteModelResponse> DeleteModel(const Composer& composer, const rpc::Call& call,
                                                    const v1::DeleteModelRequest& asked,
                                                    store::Transaction& transaction);

absl::StatusOr<v1::Model> ForkModel(const Composer& composer, const rpc::Call& call,
                                    const v1::ForkModelRequest& asked,
                                    store::Transaction& transaction);

absl::StatusOr<v1::Model> UndoModel(const Composer& composer, const rpc::Call& call,
                                    const v1::UndoModelRequest& asked,
                                    store::Transaction& transaction);

absl::StatusOr<v1::Model> RedoModel(const Composer& composer, const rpc::Call& call,
                                    const v1::RedoModelRequest& asked,
                                    store::Transaction& transaction);

absl::StatusOr<v1::ListModelStepsResponse> ListModelSteps(const Composer& composer,
                                                          const rpc::Call& call,
                                                          const v1::ListModelStepsRequest& asked);

// A picture as a message.
absl::StatusOr<v1::ModelPicture> DrawModel(const Composer& composer, const rpc::Call& call,
                                           const v1::DrawModelRequest& asked);

}  // namespace mortise::composer::methods
