// What answers the methods of notes.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "notes.pb.h"

namespace mortise::notes {

// What the methods stand on; it outlives them.
struct Notes {
  store::Store* store;
};

namespace methods {

absl::StatusOr<Note> CreateNote(const Notes& notes, const rpc::Call& call,
                                const CreateNoteRequest& asked, store::Transaction& transaction);

absl::StatusOr<Note> GetNote(const Notes& notes, const rpc::Call& call,
                             const GetNoteRequest& asked);

absl::StatusOr<ListNotesResponse> ListNotes(const Notes& notes, const rpc::Call& call,
                                            const ListNotesRequest& asked);

absl::StatusOr<Note> UpdateNote(const Notes& notes, const rpc::Call& call,
                                const UpdateNoteRequest& asked, store::Transaction& transaction);

}  // namespace methods
}  // namespace mortise::notes
