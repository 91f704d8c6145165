// The method that writes a model into the catalog.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/composer.h"

namespace mortise::composer::methods {

// Imports the shapes that the catalog does not know, the model's assembly and its template, as the
// caller. An assembly that was new goes again
// where its template is refused. Fails as composer.proto says, and as the catalog.
absl::StatusOr<v1::SavedModel> WriteIntoCatalog(const Composer& composer, const rpc::Call& call,
                                                const v1::SaveModelRequest& asked);

// Keeps with the model what it was saved as.
absl::StatusOr<v1::SavedModel> SaveModel(const Composer& composer, const rpc::Call& call,
                                         const v1::SaveModelRequest& asked,
                                         const v1::SavedModel& saved,
                                         store::Transaction& transaction);

}  // namespace mortise::composer::methods
