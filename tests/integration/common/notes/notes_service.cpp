#include "tests/integration/common/notes/notes_service.h"

#include "common/rpc/method_overrides.h"
#include "notes.grpc.pb.h"
#include "tests/integration/common/notes/note_methods.h"

namespace mortise::notes {
namespace {

class NotesAdapter final : public NoteService::CallbackService {
  using Contract = NoteService::CallbackService;

 public:
  explicit NotesAdapter(const rpc::ServiceEnvironment& environment)
      : notes_{.store = environment.store},
        endpoint_(environment.dispatcher, "mortise.notes.NoteService") {}

  MORTISE_MUTATION(CreateNote, rpc::With(notes_, methods::CreateNote))
  MORTISE_QUERY(GetNote, rpc::With(notes_, methods::GetNote))
  MORTISE_QUERY(ListNotes, rpc::With(notes_, methods::ListNotes))
  MORTISE_MUTATION(UpdateNote, rpc::With(notes_, methods::UpdateNote))

 private:
  const Notes notes_;
  rpc::Endpoint endpoint_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment) {
  return std::vector<std::shared_ptr<grpc::Service>>{std::make_shared<NotesAdapter>(environment)};
}

}  // namespace mortise::notes
