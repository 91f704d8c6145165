// What made each revision of a model: who did what, and what it changed. Unlike the steps of
// model_records.h, which can be undone, it only grows.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/author.h"
#include "common/store/store.h"
#include "mortise/v1/composer.pb.h"

namespace mortise::composer {

// Records hold mortise.v1.ModelStep; keys are "{model id}/{revision}".
inline constexpr char kRevisions[] = "modelRevisions";

// Adds to a step which components and parts are not the same after as before.
void AddChanges(const v1::Model& before, const v1::Model& after, v1::ModelStep* step);

// Writes what made the revision that `head` has now. `before` and `after` have the components and
// parts of the states.
absl::Status PutRevision(store::Transaction& transaction, const v1::Model& head,
                         const std::string& text, const v1::Model& before, const v1::Model& after,
                         const resources::Author& author);

// Returns a page of what made a model's revisions. NOT_FOUND; INVALID_ARGUMENT naming the field.
absl::StatusOr<v1::ListModelStepsResponse> ReadRevisions(store::Store& store,
                                                         const v1::ListModelStepsRequest& asked);

}  // namespace mortise::composer
