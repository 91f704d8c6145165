// What materials and items have in common as records: one message each, with revisions, external
// ids and labels, and somebody who created it.
#pragma once

#include <google/protobuf/util/time_util.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/resources/author.h"
#include "common/resources/record_page.h"
#include "common/store/store.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_tags.h"
#include "services/catalog/records/record_update.h"
#include "services/catalog/records/shipped_revisions.h"

namespace mortise::catalog {

// What a kind of them is called.
struct RowKind {
  const char* names;  // the collection: "items" of "items/hex-nut-m8"
  const char* name;   // one of them, in events ("item.created") and requests ("item.price")
};

// Takes away what records do not say, as the store says it.
template <typename Message>
void ClearWhatTheStoreSays(Message* message) {
  message->clear_revision();
  message->clear_create_time();
  if constexpr (requires { message->clear_update_time(); }) message->clear_update_time();
}

// Whether both say the same about the thing, whatever their tags.
template <typename Message>
bool HaveSameContent(Message one, Message other) {
  for (Message* message : {&one, &other}) {
    ClearWhatTheStoreSays(message);
    resources::ClearTags(message);
  }
  return one.SerializeAsString() == other.SerializeAsString();
}

// Returns the message of a record. INTERNAL, STORAGE_FAILED if it holds none.
template <typename Message>
absl::StatusOr<Message> RowOf(const RowKind& kind, const store::Record& record) {
  using google::protobuf::util::TimeUtil;
  MORTISE_ASSIGN_OR_RETURN(Message message, resources::ParseRecord<Message>(kind.names, record));
  message.set_revision(record.revision);
  *message.mutable_create_time() =
      TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(record.created_at));
  if constexpr (requires { message.mutable_update_time(); }) {
    *message.mutable_update_time() =
        TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(record.updated_at));
  }
  return message;
}

// As GetItem.
template <typename Message>
absl::StatusOr<Message> GetRow(store::ReadTransaction& transaction, const RowKind& kind,
                               const std::string& name, int64_t revision) {
  MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                           GetRecord(transaction, kind.names, name, revision));
  return RowOf<Message>(kind, record);
}

// Writes a message as the revision after `present`, whose creator it keeps, and tells of it; null
// for a new one, which is by the author. What is still as it shipped but for its tags stays known
// as that. Returns the revision.
template <typename Message>
absl::StatusOr<int64_t> PutRow(store::Transaction& transaction, const RowKind& kind,
                               Message message, const Message* present,
                               const resources::Author& author) {
  const bool is_new = present == nullptr;
  message.set_creator(is_new ? author.user : present->creator());
  ClearWhatTheStoreSays(&message);
  const std::string payload = message.SerializeAsString();
  MORTISE_ASSIGN_OR_RETURN(
      const int64_t revision,
      is_new ? PutNew(transaction, kind.names, message.name(), payload)
             : PutNext(transaction, kind.names, message.name(), payload, present->revision()));
  if (!is_new && HaveSameContent(*present, message)) {
    MORTISE_RETURN_IF_ERROR(
        MoveShippedRevision(transaction, message.name(), present->revision(), revision));
  }
  MORTISE_RETURN_IF_ERROR(
      AppendEvent(transaction, absl::StrCat(kind.name, is_new ? ".created" : ".updated"),
                  message.name(), {{"title", message.title()}, {"revision", revision}}, author));
  return revision;
}

// As CreateItem. `check(transaction, message)` gives a status about fields of the message.
template <typename Message, typename Check>
absl::StatusOr<Message> CreateRow(store::Transaction& transaction, const RowKind& kind,
                                  const Message& message, const Check& check,
                                  const resources::Author& author) {
  MORTISE_RETURN_IF_ERROR(UnderField(kind.name, check(transaction, message)));
  MORTISE_RETURN_IF_ERROR(PutRow<Message>(transaction, kind, message, nullptr, author).status());
  return GetRow<Message>(transaction, kind, message.name(), 0);
}

// As UpdateItem; `check` as for CreateRow.
template <typename Message, typename Check>
absl::StatusOr<Message> UpdateRow(store::Transaction& transaction, const RowKind& kind,
                                  const Message& changes, const google::protobuf::FieldMask& mask,
                                  const Check& check, const resources::Author& author) {
  MORTISE_RETURN_IF_ERROR(CheckUpdateMask<Message>(mask));
  const absl::StatusOr<Message> present = GetRow<Message>(transaction, kind, changes.name(), 0);
  if (absl::IsInvalidArgument(present.status())) return UnderField(kind.name, present.status());
  MORTISE_RETURN_IF_ERROR(present.status());
  if (present->revision() != changes.revision()) {
    return StaleRevision(present->name(), changes.revision(), present->revision());
  }
  const Message changed = Updated(*present, changes, mask);
  MORTISE_RETURN_IF_ERROR(UnderField(kind.name, check(transaction, changed)));
  MORTISE_RETURN_IF_ERROR(PutRow<Message>(transaction, kind, changed, &*present, author).status());
  return GetRow<Message>(transaction, kind, changed.name(), 0);
}

// As ReplaceItem.
template <typename Message>
absl::StatusOr<Replacement> ReplaceRow(store::Transaction& transaction, const RowKind& kind,
                                       Message message, const resources::Author& author) {
  const absl::StatusOr<Message> present = GetRow<Message>(transaction, kind, message.name(), 0);
  if (absl::IsNotFound(present.status())) {
    MORTISE_ASSIGN_OR_RETURN(
        const int64_t revision,
        PutRow<Message>(transaction, kind, std::move(message), nullptr, author));
    return Replacement{0, revision};
  }
  MORTISE_RETURN_IF_ERROR(present.status());
  KeepTags(*present, &message);
  Replacement replaced{present->revision(), present->revision()};
  if (resources::HaveSameTags(*present, message) && HaveSameContent(*present, message)) {
    return replaced;
  }
  MORTISE_ASSIGN_OR_RETURN(
      replaced.revision, PutRow<Message>(transaction, kind, std::move(message), &*present, author));
  return replaced;
}

}  // namespace mortise::catalog
