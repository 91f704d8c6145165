#include "services/composer/service/drag_stream.h"

#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/mutation_log.h"
#include "services/composer/records/model_records.h"
#include "services/composer/service/drag_methods.h"
#include "services/composer/service/part_changes.h"

namespace mortise::composer {
namespace {

using Writer = std::shared_ptr<rpc::StreamWriter<v1::DragNodeResponse>>;
using Answer = absl::StatusOr<std::optional<v1::DragNodeResponse>>;

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

// One drag, shared by who takes messages and who answers them.
class DragInProgress {
 public:
  DragInProgress(const Composer& composer, rpc::Call call)
      : composer_(composer), call_(std::move(call)) {}

  absl::Status Begin(const v1::DragNodeRequest::Begin& begin) {
    MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<OpenDrag> drag,
                             FindDrag(composer_, call_, begin.name(), begin.revision(),
                                      {begin.component(), begin.node(), begin.control()}));
    const std::lock_guard lock(mutex_);
    begin_ = begin;
    drag_ = drag;
    told_ = drag->stored();
    v1::DragNodeResponse& begun = first_.emplace();
    begun.mutable_begun()->set_revision(begin.revision());
    begun.mutable_begun()->set_value(drag->value());
    return absl::OkStatus();
  }

  void To(const v1::DragNodeRequest::To& to) {
    const std::lock_guard lock(mutex_);
    waiting_ = to;
  }

  void Commit(const v1::DragNodeRequest::Commit& commit) {
    const std::lock_guard lock(mutex_);
    waiting_.reset();
    commit_ = commit;
  }

  void End() {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }

  // What is to be sent next; nothing if there is none yet. Called by one at a time. `is_last` says
  // whether the stream ends here.
  Answer Next(bool* is_last) {
    std::unique_lock lock(mutex_);
    if (first_) return std::exchange(first_, std::nullopt);
    if (waiting_) {
      const v1::DragNodeRequest::To to = *std::exchange(waiting_, std::nullopt);
      lock.unlock();
      return Moved(to);
    }
    if (commit_) {
      const v1::DragNodeRequest::Commit commit = *std::exchange(commit_, std::nullopt);
      has_ended_ = true;
      lock.unlock();
      return Committed(commit);
    }
    *is_last = has_ended_;
    return std::optional<v1::DragNodeResponse>();
  }

 private:
  Answer Moved(const v1::DragNodeRequest::To& to) {
    MORTISE_ASSIGN_OR_RETURN(OpenDrag::Dragged there, drag_->To(to.value()));
    v1::DragNodeResponse response;
    response.mutable_moved()->set_sequence(to.sequence());
    v1::DragPreview& preview = *response.mutable_moved()->mutable_preview();
    preview.set_revision(begin_.revision());
    preview.set_value(to.value());
    preview.set_reached(there.reached);
    AddChanges(told_, there.parts, &preview);
    told_ = std::move(there.parts);
    return std::optional<v1::DragNodeResponse>(std::move(response));
  }

  Answer Committed(const v1::DragNodeRequest::Commit& commit) {
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
    return std::optional<v1::DragNodeResponse>(std::move(response));
  }

  const Composer& composer_;
  const rpc::Call call_;
  std::mutex mutex_;
  // Set by Begin, before anything is answered.
  v1::DragNodeRequest::Begin begin_;
  std::shared_ptr<OpenDrag> drag_;
  std::vector<v1::ModelPart> told_;  // as the client has them; of who answers
  // Guarded by mutex_:
  std::optional<v1::DragNodeResponse> first_;
  std::optional<v1::DragNodeRequest::To> waiting_;
  std::optional<v1::DragNodeRequest::Commit> commit_;
  bool has_ended_ = false;
};

class DragStream : public rpc::StreamReader<v1::DragNodeRequest> {
 public:
  DragStream(const Composer& composer, const rpc::Call& call, Writer writer)
      : drag_(std::make_shared<DragInProgress>(composer, call)), writer_(std::move(writer)) {}

  absl::Status OnMessage(const v1::DragNodeRequest& message) override {
    if (is_over_) return InvalidField("message", "nothing comes after commit");
    if (message.has_begin() == has_begun_) {
      return InvalidField("message",
                          has_begun_ ? "the drag has begun already" : "the first must be begin");
    }
    if (message.has_begin()) {
      MORTISE_RETURN_IF_ERROR(drag_->Begin(message.begin()));
      has_begun_ = true;
      BeginAnswering();
      return absl::OkStatus();
    }
    if (message.has_commit()) {
      is_over_ = true;
      drag_->Commit(message.commit());
    } else if (message.has_to()) {
      drag_->To(message.to());
    } else {
      return InvalidField("message", "is missing");
    }
    writer_->Wake();
    return absl::OkStatus();
  }

  void OnEnd() override {
    if (!has_begun_) {
      writer_->Finish(InvalidField("message", "no begin was sent"));
      return;
    }
    drag_->End();
    writer_->Wake();
  }

 private:
  void BeginAnswering() {
    const std::weak_ptr<rpc::StreamWriter<v1::DragNodeResponse>> weak = writer_;
    writer_->Pull([drag = drag_, weak]() -> mortise::composer::Answer {
      bool is_last = false;
      auto answer = drag->Next(&is_last);
      const Writer writer = weak.lock();
      if (is_last && writer != nullptr) writer->Finish(absl::OkStatus());
      return answer;
    });
  }

  const std::shared_ptr<DragInProgress> drag_;
  const Writer writer_;
  bool has_begun_ = false;
  bool is_over_ = false;
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

std::unique_ptr<rpc::StreamReader<v1::DragNodeRequest>> OpenDragStream(const Composer& composer,
                                                                       const rpc::Call& call,
                                                                       Writer writer) {
  return std::make_unique<DragStream>(composer, call, std::move(writer));
}

}  // namespace mortise::composer
