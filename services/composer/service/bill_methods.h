// The method that says what a model is made of. composer.proto says what it takes and gives.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/composer.h"

namespace mortise::composer::methods {

absl::StatusOr<v1::ModelBill> GetModelBill(const Composer& composer, const rpc::Call& call,
                                           const v1::GetModelBillRequest& asked);

}  // namespace mortise::composer::methods
