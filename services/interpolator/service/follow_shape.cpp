#include "services/interpolator/service/follow_shape.h"

#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/server_limits.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/map_shape.h"
#include "services/interpolator/service/mesh_messages.h"

namespace mortise::interpolator {
namespace {

using Request = v1::FollowMapShapeRequest;
using Writer = std::shared_ptr<rpc::StreamWriter<v1::MapShape>>;
using Answer = absl::StatusOr<std::optional<v1::MapShape>>;

// Of a mesh in one message.
constexpr std::size_t kMeshPart = std::size_t{1} << 20;

// What is followed, shared by who takes messages and who answers them.
class FollowedMap {
 public:
  explicit FollowedMap(const Interpolator& interpolator) : interpolator_(interpolator) {}

  absl::Status Begin(const Request::Begin& begin) {
    MORTISE_ASSIGN_OR_RETURN(map_, interpolator_.loaded->Get(begin.name()));
    MORTISE_ASSIGN_OR_RETURN(demand_, ReadShapeDemand(map_->record, begin));
    return absl::OkStatus();
  }

  absl::Status To(const Request::To& to) {
    MORTISE_RETURN_IF_ERROR(ReadPoint(map_->record, to.point()).status());
    const std::lock_guard lock(mutex_);
    if (last_ && to.sequence() <= *last_) {
      return InvalidField("sequence", "must be larger than that of the point before");
    }
    last_ = to.sequence();
    waiting_ = to;
    return absl::OkStatus();
  }

  void End() {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }

  // What is to be sent next; nothing if there is none yet. Called by one at a time. `is_last` says
  // whether the stream ends here.
  Answer Next(bool* is_last) {
    if (ready_.empty()) {
      std::optional<Request::To> to;
      {
        const std::lock_guard lock(mutex_);
        to = std::exchange(waiting_, std::nullopt);
        if (!to) *is_last = has_ended_;
      }
      if (!to) return std::nullopt;
      MORTISE_RETURN_IF_ERROR(Prepare(*to));
    }
    v1::MapShape next = std::move(ready_.front());
    ready_.pop_front();
    return std::optional<v1::MapShape>(std::move(next));
  }

 private:
  absl::Status Prepare(const Request::To& to) {
    MORTISE_ASSIGN_OR_RETURN(AnsweredShape answer,
                             ShapeAt(*map_, *interpolator_.shapes, demand_, to.point(), scratch_));
    v1::MapShape& shape = answer.shape;
    shape.set_sequence(to.sequence());
    if (answer.canonical == nullptr || std::pair(shape.structure(), shape.mesh()) == told_) {
      MORTISE_RETURN_IF_ERROR(CheckMessageSize(shape));
      ready_.push_back(std::move(shape));
      return absl::OkStatus();
    }
    told_ = {shape.structure(), shape.mesh()};
    std::vector<v1::MapMesh> mesh = MeshMessages(*answer.canonical, shape.structure(), shape.mesh(),
                                                 demand_.geometry, kMeshPart);
    for (v1::MapShape& message :
         WithMesh(std::move(shape), std::move(mesh), rpc::kMaxMessageBytes)) {
      MORTISE_RETURN_IF_ERROR(CheckMessageSize(message));
      ready_.push_back(std::move(message));
    }
    return absl::OkStatus();
  }

  const Interpolator& interpolator_;
  // Set by Begin, before anything is answered.
  std::shared_ptr<const LoadedMap> map_;
  ShapeDemand demand_;
  // Of who answers:
  BlendedShape scratch_;
  std::pair<int, int> told_ = {-1, -1};  // structure and mesh that the client has
  std::deque<v1::MapShape> ready_;
  std::mutex mutex_;
  // Guarded by mutex_:
  std::optional<std::int64_t> last_;  // sequence
  std::optional<Request::To> waiting_;
  bool has_ended_ = false;
};

class ShapeStream : public rpc::StreamReader<Request> {
 public:
  ShapeStream(const Interpolator& interpolator, Writer writer)
      : followed_(std::make_shared<FollowedMap>(interpolator)), writer_(std::move(writer)) {}

  absl::Status OnMessage(const Request& message) override {
    if (message.has_begin() == has_begun_) {
      return InvalidField("message",
                          has_begun_ ? "it has begun already" : "the first must be begin");
    }
    if (message.has_begin()) {
      const absl::Status begun = followed_->Begin(message.begin());
      if (!begun.ok()) return UnderField("begin", begun);
      has_begun_ = true;
      BeginAnswering();
      return absl::OkStatus();
    }
    if (!message.has_to()) return InvalidField("message", "is missing");
    if (const absl::Status taken = followed_->To(message.to()); !taken.ok()) {
      return UnderField("to", taken);
    }
    writer_->Wake();
    return absl::OkStatus();
  }

  void OnEnd() override {
    if (!has_begun_) {
      writer_->Finish(InvalidField("message", "no begin was sent"));
      return;
    }
    followed_->End();
    writer_->Wake();
  }

 private:
  void BeginAnswering() {
    const std::weak_ptr<rpc::StreamWriter<v1::MapShape>> weak = writer_;
    writer_->Pull([followed = followed_, weak]() -> Answer {
      bool is_last = false;
      auto answer = followed->Next(&is_last);
      const Writer writer = weak.lock();
      if (is_last && writer != nullptr) writer->Finish(absl::OkStatus());
      return answer;
    });
  }

  const std::shared_ptr<FollowedMap> followed_;
  const Writer writer_;
  bool has_begun_ = false;
};

}  // namespace

std::unique_ptr<rpc::StreamReader<Request>> OpenShapeStream(const Interpolator& interpolator,
                                                            Writer writer) {
  return std::make_unique<ShapeStream>(interpolator, std::move(writer));
}

}  // namespace mortise::interpolator
