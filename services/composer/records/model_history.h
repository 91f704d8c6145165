// What made each revision of a model: who did what, and what it changed. Unlike the steps of
// model_records.h, which can be undone, it only grows.
#pragma once

#include <cstdint>
#include <optional>
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

// A component or node of a model that a change is about.
struct NamedNode {
  std::string component;            // ModelComponent; empty for none
  std::optional<std::string> node;  // of what is connected; empty for all of it
};

// Returns OK where no step after `revision`, up to the present one of `head`, has changed what is
// named. ABORTED, REBASE_CONFLICT, naming the model, with the steps that have; STALE_REVISION where
// `revision` is none that the model has had, or more than 1000 steps ago.
absl::Status CheckUntouched(store::ReadTransaction& transaction, const v1::Model& head,
                            std::int64_t revision, const NamedNode& named);

// Returns a page of what made a model's revisions. NOT_FOUND; INVALID_ARGUMENT naming the field.
absl::StatusOr<v1::ListModelStepsResponse> ReadRevisions(store::Store& store,
                                                         const v1::ListModelStepsRequest& asked);

}  // namespace mortise::composer
