#include "services/composer/records/model_records.h"

#include <google/protobuf/util/time_util.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/messages/message_digest.h"
#include "services/composer/records/drawing_records.h"
#include "services/composer/records/model_history.h"

namespace mortise::composer {
namespace {

constexpr char kSteps[] = "modelSteps";
constexpr int kAtOnce = 1000;

std::string IdOf(const std::string& name) { return name.substr(name.find('/') + 1); }

std::string StepKey(const std::string& name, int number) {
  return absl::StrFormat("%s/%09d", IdOf(name), number);
}

google::protobuf::Timestamp TimeOf(const store::Transaction& transaction) {
  return google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
}

absl::StatusOr<ModelStep> ReadStep(store::ReadTransaction& transaction, const std::string& name,
                                   int number) {
  const absl::StatusOr<store::Record> record = transaction.Get(kSteps, StepKey(name, number));
  // A model without its history is damaged, not missing.
  if (absl::IsNotFound(record.status())) {
    return StorageFailed(absl::StrCat(kSteps, "/", StepKey(name, number)), "is missing");
  }
  MORTISE_RETURN_IF_ERROR(record.status());
  return resources::ParseRecord<ModelStep>(kSteps, *record);
}

absl::Status CheckRevision(const v1::Model& head, std::int64_t revision) {
  if (head.revision() == revision) return absl::OkStatus();
  return StaleRevision(head.name(), revision, head.revision());
}

// What the record says of the components of a state.
void SetComponents(const v1::Model& shown, v1::Model* head) {
  *head->mutable_components() = shown.components();
  for (v1::ModelComponent& component : *head->mutable_components()) {
    component.clear_alignments();
    component.clear_connections();
  }
}

absl::Status WriteHead(store::Transaction& transaction, const v1::Model& head) {
  return transaction.Put(kModels.kind, IdOf(head.name()), head.SerializeAsString()).status();
}

absl::Status Tell(store::Transaction& transaction, const char* what, const v1::Model& head,
                  const resources::Author& author) {
  const nlohmann::json data = {{"revision", head.revision()}, {"digest", head.digest()}};
  return transaction.AppendEvent({.type = absl::StrCat(kModels.event, ".", what),
                                  .subject = head.name(),
                                  .payload = data.dump(),
                                  .trace_id = author.trace_id});
}

// Writes a state as the step `number`, and makes the head that of it. The head's revision and
// history are the caller's.
absl::Status WriteStep(store::Transaction& transaction, int number, const ModelState& state,
                       const std::string& text, const resources::Author& author, v1::Model* head) {
  ModelStep step;
  step.set_text(text);
  step.set_user(author.user);
  *step.mutable_time() = TimeOf(transaction);
  *step.mutable_state() = state;
  step.set_digest(parametric::MessageDigest(state));
  head->set_digest(step.digest());
  head->set_last_step(text);
  SetComponents(state.shown(), head);
  *head->mutable_update_time() = step.time();
  return transaction.Put(kSteps, StepKey(head->name(), number), step.SerializeAsString()).status();
}

// Removes all records of a kind whose keys begin so.
absl::Status DeleteBelow(store::Transaction& transaction, const char* kind,
                         const std::string& prefix) {
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(
        const std::vector<store::Record> records,
        transaction.List(kind, {.key_prefix = prefix, .limit = kAtOnce, .without_payloads = true}));
    for (const store::Record& record : records) {
      MORTISE_RETURN_IF_ERROR(transaction.Delete(kind, record.key));
    }
    if (static_cast<int>(records.size()) < kAtOnce) return absl::OkStatus();
  }
}

}  // namespace

absl::StatusOr<StoredModel> ReadModel(store::ReadTransaction& transaction,
                                      const std::string& name) {
  StoredModel model;
  MORTISE_ASSIGN_OR_RETURN(model.head, kModels.Get(transaction, name));
  MORTISE_ASSIGN_OR_RETURN(ModelStep step, ReadStep(transaction, name, model.head.undo_steps()));
  model.state = std::move(*step.mutable_state());
  return model;
}

absl::StatusOr<StoredModel> ReadModel(store::Store& store, const std::string& name) {
  return resources::ReadFrom<StoredModel>(
      store, [&](store::ReadTransaction& transaction) { return ReadModel(transaction, name); });
}

absl::StatusOr<StoredModel> ReadModelAt(store::ReadTransaction& transaction,
                                        const std::string& name, std::int64_t revision) {
  MORTISE_ASSIGN_OR_RETURN(StoredModel model, ReadModel(transaction, name));
  MORTISE_RETURN_IF_ERROR(CheckRevision(model.head, revision));
  return model;
}

absl::StatusOr<StoredModel> ReadModelAt(store::Store& store, const std::string& name,
                                        std::int64_t revision) {
  return resources::ReadFrom<StoredModel>(store, [&](store::ReadTransaction& transaction) {
    return ReadModelAt(transaction, name, revision);
  });
}

absl::StatusOr<StoredModel> ReadModelSince(store::Store& store, const std::string& name,
                                           std::int64_t revision, const NamedNode& named) {
  return resources::ReadFrom<StoredModel>(
      store, [&](store::ReadTransaction& transaction) -> absl::StatusOr<StoredModel> {
        MORTISE_ASSIGN_OR_RETURN(StoredModel model, ReadModel(transaction, name));
        if (model.head.revision() == revision) return model;
        MORTISE_RETURN_IF_ERROR(CheckUntouched(transaction, model.head, revision, named));
        return model;
      });
}

v1::Model ShownModel(const StoredModel& model) {
  v1::Model shown = model.head;
  *shown.mutable_components() = model.state.shown().components();
  *shown.mutable_parts() = model.state.shown().parts();
  *shown.mutable_groups() = model.state.shown().groups();
  *shown.mutable_warnings() = model.state.shown().warnings();
  return shown;
}

absl::StatusOr<StoredModel> CreateRecord(store::Transaction& transaction, const std::string& id,
                                         v1::Model head, ModelState state, const std::string& step,
                                         const resources::Author& author) {
  head.set_name(absl::StrCat(kModels.names, "/", id));
  const absl::Status present = transaction.Get(kModels.kind, id).status();
  if (present.ok()) return ResourceExists(head.name());
  if (!absl::IsNotFound(present)) return present;
  head.set_revision(1);
  head.set_creator(author.user);
  *head.mutable_create_time() = TimeOf(transaction);
  MORTISE_RETURN_IF_ERROR(WriteStep(transaction, 0, state, step, author, &head));
  MORTISE_RETURN_IF_ERROR(WriteHead(transaction, head));
  MORTISE_RETURN_IF_ERROR(
      PutRevision(transaction, head, head.last_step(), v1::Model(), state.shown(), author));
  MORTISE_RETURN_IF_ERROR(Tell(transaction, "created", head, author));
  return StoredModel{std::move(head), std::move(state)};
}

absl::StatusOr<StoredModel> AddStep(store::Transaction& transaction, const v1::Model& seen,
                                    ModelState state, const std::string& step,
                                    const resources::Author& author) {
  // Tags may have changed meanwhile.
  MORTISE_ASSIGN_OR_RETURN(v1::Model head, kModels.Get(transaction, seen.name()));
  MORTISE_RETURN_IF_ERROR(CheckRevision(head, seen.revision()));
  MORTISE_ASSIGN_OR_RETURN(const ModelStep before,
                           ReadStep(transaction, head.name(), head.undo_steps()));
  const int number = head.undo_steps() + 1;
  for (int undone = 0; undone < head.redo_steps(); ++undone) {
    MORTISE_RETURN_IF_ERROR(transaction.Delete(kSteps, StepKey(head.name(), number + undone)));
  }
  head.set_revision(head.revision() + 1);
  head.set_undo_steps(number);
  head.set_redo_steps(0);
  MORTISE_RETURN_IF_ERROR(WriteStep(transaction, number, state, step, author, &head));
  MORTISE_RETURN_IF_ERROR(WriteHead(transaction, head));
  MORTISE_RETURN_IF_ERROR(PutRevision(transaction, head, head.last_step(), before.state().shown(),
                                      state.shown(), author));
  MORTISE_RETURN_IF_ERROR(Tell(transaction, "updated", head, author));
  return StoredModel{std::move(head), std::move(state)};
}

absl::StatusOr<StoredModel> MoveInHistory(store::Transaction& transaction, const std::string& name,
                                          std::int64_t revision, HistoryMove move,
                                          const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(v1::Model head, kModels.Get(transaction, name));
  MORTISE_RETURN_IF_ERROR(CheckRevision(head, revision));
  const bool undo = move == HistoryMove::kUndo;
  if (undo && head.undo_steps() == 0) {
    return PreconditionFailed("NOTHING_TO_UNDO", absl::StrCat(name, " is as it began"), "name");
  }
  if (!undo && head.redo_steps() == 0) {
    return PreconditionFailed(
        "NOTHING_TO_REDO", absl::StrCat("nothing of ", name, " was undone since its last change"),
        "name");
  }
  MORTISE_ASSIGN_OR_RETURN(const ModelStep before, ReadStep(transaction, name, head.undo_steps()));
  const int forward = undo ? -1 : 1;
  head.set_revision(head.revision() + 1);
  head.set_undo_steps(head.undo_steps() + forward);
  head.set_redo_steps(head.redo_steps() - forward);
  MORTISE_ASSIGN_OR_RETURN(ModelStep step, ReadStep(transaction, name, head.undo_steps()));
  head.set_digest(step.digest());
  head.set_last_step(step.text());
  SetComponents(step.state().shown(), &head);
  *head.mutable_update_time() = TimeOf(transaction);
  MORTISE_RETURN_IF_ERROR(WriteHead(transaction, head));
  MORTISE_RETURN_IF_ERROR(PutRevision(
      transaction, head, absl::StrCat(undo ? "undo " : "redo ", undo ? before.text() : step.text()),
      before.state().shown(), step.state().shown(), author));
  MORTISE_RETURN_IF_ERROR(Tell(transaction, "updated", head, author));
  return StoredModel{std::move(head), std::move(*step.mutable_state())};
}

absl::Status PutHead(store::Transaction& transaction, const v1::Model& head,
                     const resources::Author& author) {
  MORTISE_RETURN_IF_ERROR(WriteHead(transaction, head));
  return Tell(transaction, "updated", head, author);
}

absl::Status DeleteRecords(store::Transaction& transaction, const std::string& name,
                           std::int64_t revision, const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Model head, kModels.Get(transaction, name));
  MORTISE_RETURN_IF_ERROR(CheckRevision(head, revision));
  const std::string prefix = IdOf(name) + "/";
  for (const char* kind : {kSteps, kDrawings, kShapes, kRevisions}) {
    MORTISE_RETURN_IF_ERROR(DeleteBelow(transaction, kind, prefix));
  }
  MORTISE_RETURN_IF_ERROR(transaction.Delete(kModels.kind, IdOf(name)));
  return Tell(transaction, "deleted", head, author);
}

}  // namespace mortise::composer
