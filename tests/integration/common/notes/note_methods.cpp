#include "tests/integration/common/notes/note_methods.h"

#include <google/protobuf/util/time_util.h>

#include <utility>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/resources/collection.h"

namespace mortise::notes::methods {
namespace {

constexpr std::size_t kMaxTextBytes = 2000;

// A line a resource: this gives Get, List with filters, and changes of external ids and labels.
constexpr resources::Collection<Note> kNotes = {.names = "notes", .kind = "notes", .event = "note"};

absl::Status CheckText(const std::string& text) {
  if (!text.empty() && text.size() <= kMaxTextBytes) return absl::OkStatus();
  return InvalidField("text", "must have 1 to 2000 bytes");
}

}  // namespace

absl::StatusOr<Note> CreateNote(const Notes&, const rpc::Call& call, const CreateNoteRequest& asked,
                                store::Transaction& transaction) {
  // All that is wrong is told at once, before anything is stored.
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(ParseResourceName(asked.subject(), "templates", "subject").status(),
                        CheckText(asked.text())),
      resources::ValidateTags(asked)));
  const resources::Author author = rpc::AuthorOf(call);
  const std::string id = NewIdentifier();
  Note note;
  note.set_name(absl::StrCat(kNotes.names, "/", id));
  note.set_subject(asked.subject());
  note.set_text(asked.text());
  resources::CopyTags(asked, &note);
  note.set_creator(author.user);
  *note.mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
  MORTISE_RETURN_IF_ERROR(transaction.Put(kNotes.kind, id, note.SerializeAsString()).status());
  MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "note.created",
                                                   .subject = note.name(),
                                                   .payload = "{}",
                                                   .trace_id = author.trace_id}));
  return note;
}

absl::StatusOr<Note> GetNote(const Notes& notes, const rpc::Call&, const GetNoteRequest& asked) {
  return kNotes.Get(*notes.store, asked.name());
}

absl::StatusOr<ListNotesResponse> ListNotes(const Notes& notes, const rpc::Call&,
                                            const ListNotesRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(resources::Page<Note> page,
                           kNotes.List(*notes.store, asked, [&](const Note& note) {
                             return asked.subject().empty() || note.subject() == asked.subject();
                           }));
  return resources::ToResponse(std::move(page), &ListNotesResponse::mutable_notes);
}

absl::StatusOr<Note> UpdateNote(const Notes&, const rpc::Call& call, const UpdateNoteRequest& asked,
                                store::Transaction& transaction) {
  return kNotes.UpdateTags(transaction, asked.note(), asked.update_mask(), "note",
                           rpc::AuthorOf(call));
}

}  // namespace mortise::notes::methods
