// What templates and assemblies have in common as records: bundles of a message and of all that it
// uses, each revision of which is kept.
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
#include "common/resources/resource_tags.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.pb.h"
#include "mortise/v1/template.pb.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shipped_revisions.h"

namespace mortise::catalog {

// What a kind of them is called.
struct BundleKind {
  const char* names;  // the collection: "templates" of "templates/table"
  const char* name;   // one of them, in events ("template.imported") and requests
};

// Return the message that a bundle is of.
inline v1::Template& MessageOf(v1::TemplateBundle& bundle) { return *bundle.mutable_template_(); }
inline v1::Assembly& MessageOf(v1::AssemblyBundle& bundle) { return *bundle.mutable_assembly(); }

// Takes away what the service says of a message.
template <typename Message>
void ClearWhatTheServiceSays(Message* message) {
  message->clear_revision();
  message->clear_create_time();
  message->clear_digest();
  message->clear_creator();
}

// Returns the bundle of a record. INTERNAL, STORAGE_FAILED if it holds none.
template <typename Bundle>
absl::StatusOr<Bundle> BundleOf(const BundleKind& kind, const store::Record& record) {
  MORTISE_ASSIGN_OR_RETURN(Bundle bundle, resources::ParseRecord<Bundle>(kind.names, record));
  MessageOf(bundle).set_revision(record.revision);
  return bundle;
}

// Returns a revision (0: the latest). NOT_FOUND, or INVALID_ARGUMENT naming "name" or "revision".
template <typename Bundle>
absl::StatusOr<Bundle> GetBundleOf(store::ReadTransaction& transaction, const BundleKind& kind,
                                   const std::string& name, int64_t revision) {
  MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                           GetRecord(transaction, kind.names, name, revision));
  return BundleOf<Bundle>(kind, record);
}

// Writes a bundle without its shapes, which are stored, as the revision after `expected_revision`,
// and tells of it. Its creator is that of the revision before, or else the author. If the present
// revision has the same content and tags, nothing changes. What is still as it shipped but for its
// tags stays known as that. Returns the message as it then is. ABORTED if the latest revision is
// not `expected_revision`.
template <typename Bundle>
auto ImportRevision(store::Transaction& transaction, const BundleKind& kind, Bundle bundle,
                    int64_t expected_revision, const resources::Author& author)
    -> absl::StatusOr<std::decay_t<decltype(MessageOf(bundle))>> {
  auto& message = MessageOf(bundle);
  MORTISE_ASSIGN_OR_RETURN(const store::Record latest,
                           GetRecordOrNone(transaction, kind.names, message.name(), kind.name));
  if (latest.revision != expected_revision) {
    return StaleRevision(message.name(), expected_revision, latest.revision);
  }
  message.set_creator(author.user);
  bool is_same_content = false;
  if (latest.revision > 0) {
    MORTISE_ASSIGN_OR_RETURN(Bundle present_bundle, BundleOf<Bundle>(kind, latest));
    auto& present = MessageOf(present_bundle);
    is_same_content = present.digest() == message.digest();
    if (is_same_content && resources::HaveSameTags(present, message)) return std::move(present);
    message.set_creator(present.creator());
  }
  bundle.clear_shapes();
  *message.mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
  MORTISE_ASSIGN_OR_RETURN(const int64_t revision,
                           PutNext(transaction, kind.names, message.name(),
                                   bundle.SerializeAsString(), expected_revision));
  if (is_same_content) {
    MORTISE_RETURN_IF_ERROR(
        MoveShippedRevision(transaction, message.name(), expected_revision, revision));
  }
  message.set_revision(revision);
  MORTISE_RETURN_IF_ERROR(AppendEvent(transaction, absl::StrCat(kind.name, ".imported"),
                                      message.name(),
                                      {{"title", message.title()},
                                       {"revision", revision},
                                       {"digest", message.digest()},
                                       {"parts", message.parts_size()}},
                                      author));
  return std::move(message);
}

}  // namespace mortise::catalog
