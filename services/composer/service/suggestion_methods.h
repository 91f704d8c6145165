// The method that suggests what might come next. composer.proto says what it takes and gives.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/composer.h"

namespace mortise::composer::methods {

absl::StatusOr<v1::ComponentSuggestions> SuggestComponents(
    const Composer& composer, const rpc::Call& call, const v1::SuggestComponentsRequest& asked);

}  // namespace mortise::composer::methods
