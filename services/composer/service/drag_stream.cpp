#include "services/composer/service/drag_stream.h"

#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/mutation_log.h"
#include "common/rpc/streams/latest_value_stream.h"
#include "services/composer/records/model_records.h"
#include "services/composer/service/drag_methods.h"
#include "services/composer/service/part_changes.h"

namespace mortise::composer {
namespace {

// Makes the step that DragControl makes, with an audit record and the answer under its request_id.
absl::StatusOr<v1::Model> Store(const Composer& composer, const rpc::Call& call,
                                const v1::DragControlRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const rpc::MutationKey key, rpc::MakeMutationKey(call, request));
  v1::Model model;
  bool answered = false;
  const auto find_answer = [&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(answered, rpc::FindAnswer(transaction, key, &model));
    return absl::OkStatus();
  };
  MORTISE_RETURN_IF_ERROR(composer.store->Read(find_answer));
  if (answered) return model;
  MORTISE_ASSIGN_OR_RETURN(const ModelChange change, methods::DragControl(composer, call, request));
  MORTISE_RETURN_IF_ERROR(
      composer.store->Transact([&](store::Transaction& transaction) -> absl::Status {
        MORTISE_RETURN_IF_ERROR(find_answer(transaction));
        if (answered) return absl::OkStatus();
        MORTISE_ASSIGN_OR_RETURN(model, StoreChange(transaction, change, call));
        return rpc::RecordMutation(transaction, composer.service, call, key, request, model);
      }));
  return model;
}

// A drag of one control.
class DragInProgress : public rpc::FollowedSubject<v1::DragNodeRequest, v1::DragNodeResponse> {
 public:
  using Answers = absl::StatusOr<std::vector<v1::DragNodeResponse>>;

  DragInProgress(const Composer& composer, rpc::Call call)
      : composer_(composer), call_(std::move(call)) {}

  Answers Begin(const v1::DragNodeRequest& message) override {
    begin_ = message.begin();
    MORTISE_ASSIGN_OR_RETURN(drag_,
                             FindDrag(composer_, call_, begin_.name(), begin_.revision(),
                                      {begin_.component(), begin_.node(), begin_.control()}));
    told_ = drag_->stored();
    v1::DragNodeResponse begun;
    begun.mutable_begun()->set_revision(begin_.revision());
    begun.mutable_begun()->set_value(drag_->value());
    return One(std::move(begun));
  }

  absl::StatusOr<Kind> Take(const v1::DragNodeRequest& message) override {
    if (message.has_commit()) return Kind::kLast;
    if (message.has_to()) return Kind::kValue;
    return InvalidField("message", "is missing");
  }

  Answers Answer(const v1::DragNodeRequest& message) override {
    return message.has_commit() ? Committed(message.commit()) : Moved(message.to());
  }

 private:
  static std::vector<v1::DragNodeResponse> One(v1::DragNodeResponse message) {
    std::vector<v1::DragNodeResponse> messages;
    messages.push_back(std::move(message));
    return messages;
  }

  Answers Moved(const v1::DragNodeRequest::To& to) {
    MORTISE_ASSIGN_OR_RETURN(OpenDrag::Dragged there, drag_->To(to.value()));
    v1::DragNodeResponse response;
    response.mutable_moved()->set_sequence(to.sequence());
    v1::DragPreview& preview = *response.mutable_moved()->mutable_preview();
    preview.set_revision(begin_.revision());
    preview.set_value(to.value());
    preview.set_reached(there.reached);
    AddChanges(told_, there.parts, &preview);
    told_ = std::move(there.parts);
    return One(std::move(response));
  }

  Answers Committed(const v1::DragNodeRequest::Commit& commit) {
    v1::DragControlRequest request;
    request.set_request_id(commit.request_id());
    request.set_name(begin_.name());
    request.set_revision(begin_.revision());
    request.set_component(begin_.component());
    request.set_node(begin_.node());
    request.set_control(begin_.control());
    request.set_value(commit.value());
    v1::DragNodeResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_committed(), Store(composer_, call_, request));
    return One(std::move(response));
  }

  const Composer& composer_;
  const rpc::Call call_;
  // Set by Begin:
  v1::DragNodeRequest::Begin begin_;
  std::shared_ptr<OpenDrag> drag_;
  // Of Answer, after Begin:
  std::vector<v1::ModelPart> told_;  // as the client has them
};

}  // namespace

absl::StatusOr<std::shared_ptr<OpenDrag>> FindDrag(const Composer& composer, const rpc::Call& call,
                                                   const std::string& name, std::int64_t revision,
                                                   const DraggedControl& control) {
  MORTISE_ASSIGN_OR_RETURN(
      const v1::Model head,
      resources::ReadFrom<v1::Model>(*composer.store, [&](store::ReadTransaction& transaction) {
        return kModels.Get(transaction, name);
      }));
  if (head.revision() != revision) return StaleRevision(name, revision, head.revision());
  return composer.drags.DragOf(head.digest(), control, [&]() -> absl::StatusOr<OpenModel> {
    MORTISE_ASSIGN_OR_RETURN(const StoredModel stored,
                             ReadModelAt(*composer.store, name, revision));
    return Open(stored, composer.drawings, [&call] { return call.cancelled(); });
  });
}

std::unique_ptr<rpc::StreamReader<v1::DragNodeRequest>> OpenDragStream(
    const Composer& composer, const rpc::Call& call,
    std::shared_ptr<rpc::StreamWriter<v1::DragNodeResponse>> writer) {
  return rpc::FollowLatest<v1::DragNodeRequest, v1::DragNodeResponse>(
      std::make_shared<DragInProgress>(composer, call), std::move(writer));
}

}  // namespace mortise::composer
