// Models in the store: what clients see of each, and its history, a step for each change with the
// state that came of it, so that any step can be undone and done again.
//
// The state of a model is that of its step number `undo_steps`; those above can be done again.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/author.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "model_state.pb.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/records/model_history.h"

namespace mortise::composer {

// Records hold mortise.v1.Model by the model's id, without parts, groups, warnings, and what its
// components snapped by and were connected by.
inline constexpr resources::Collection<v1::Model> kModels{
    .names = "models", .kind = "models", .event = "model", .newest_first = false};

// A model as it is stored.
struct StoredModel {
  v1::Model head;    // its record
  ModelState state;  // that it is in
};

// Reads a model. NOT_FOUND; INVALID_ARGUMENT naming "name"; STORAGE_FAILED.
absl::StatusOr<StoredModel> ReadModel(store::ReadTransaction& transaction, const std::string& name);
absl::StatusOr<StoredModel> ReadModel(store::Store& store, const std::string& name);

// The same for a caller who wants to change it, and saw `revision`. ABORTED, STALE_REVISION naming
// the model, if it has another one.
absl::StatusOr<StoredModel> ReadModelAt(store::ReadTransaction& transaction,
                                        const std::string& name, std::int64_t revision);
absl::StatusOr<StoredModel> ReadModelAt(store::Store& store, const std::string& name,
                                        std::int64_t revision);

// The same for a caller who is content with a newer revision if nothing of what is named has
// changed since. Fails as CheckUntouched (model_history.h) where there is one.
absl::StatusOr<StoredModel> ReadModelSince(store::Store& store, const std::string& name,
                                           std::int64_t revision, const NamedNode& named);

// Returns the model as clients see it.
v1::Model ShownModel(const StoredModel& model);

// Writes a model that is not there yet, in the state given and without anything to undo, with the
// title, external ids and labels of `head`, and tells of it ("model.created"). ALREADY_EXISTS.
absl::StatusOr<StoredModel> CreateRecord(store::Transaction& transaction, const std::string& id,
                                         v1::Model head, ModelState state, const std::string& step,
                                         const resources::Author& author);

// Adds a step to the history of the model that `seen` was read of, in place of all that could be
// done again, and tells of it ("model.updated"). ABORTED, STALE_REVISION, if it has changed since.
absl::StatusOr<StoredModel> AddStep(store::Transaction& transaction, const v1::Model& seen,
                                    ModelState state, const std::string& step,
                                    const resources::Author& author);

// Which way through the history.
enum class HistoryMove { kUndo, kRedo };

// Goes one step through the history of a model, and tells of it ("model.updated"). ABORTED,
// STALE_REVISION; FAILED_PRECONDITION, NOTHING_TO_UNDO or NOTHING_TO_REDO.
absl::StatusOr<StoredModel> MoveInHistory(store::Transaction& transaction, const std::string& name,
                                          std::int64_t revision, HistoryMove move,
                                          const resources::Author& author);

// Writes what is no content of the design: title, tags, what it was saved as. Tells of it
// ("model.updated").
absl::Status PutHead(store::Transaction& transaction, const v1::Model& head,
                     const resources::Author& author);

// Removes a model with its history and drawings, and tells of it ("model.deleted"). ABORTED,
// STALE_REVISION; NOT_FOUND.
absl::Status DeleteRecords(store::Transaction& transaction, const std::string& name,
                           std::int64_t revision, const resources::Author& author);

}  // namespace mortise::composer
