#include "services/interpolator/service/follow_shape.h"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/server_limits.h"
#include "common/rpc/streams/latest_value_stream.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/map_shape.h"
#include "services/interpolator/service/mesh_messages.h"

namespace mortise::interpolator {
namespace {

using Request = v1::FollowMapShapeRequest;
using Subject = rpc::FollowedSubject<Request, v1::MapShape>;

// Of a mesh in one message.
constexpr std::size_t kMeshPart = std::size_t{1} << 20;

// The shapes of a map's designs.
class FollowedMap : public Subject {
 public:
  explicit FollowedMap(const Interpolator& interpolator) : interpolator_(interpolator) {}

  absl::StatusOr<std::vector<v1::MapShape>> Begin(const Request& message) override {
    if (const absl::Status begun = Open(message.begin()); !begun.ok()) {
      return UnderField("begin", begun);
    }
    return std::vector<v1::MapShape>();
  }

  absl::StatusOr<Kind> Take(const Request& message) override {
    if (!message.has_to()) return InvalidField("message", "is missing");
    if (const absl::Status checked = Check(message.to()); !checked.ok()) {
      return UnderField("to", checked);
    }
    return Kind::kValue;
  }

  absl::StatusOr<std::vector<v1::MapShape>> Answer(const Request& message) override {
    const Request::To& to = message.to();
    MORTISE_ASSIGN_OR_RETURN(AnsweredShape answer,
                             ShapeAt(*map_, *interpolator_.shapes, demand_, to.point(), scratch_));
    v1::MapShape& shape = answer.shape;
    shape.set_sequence(to.sequence());
    std::vector<v1::MapShape> messages;
    if (answer.canonical == nullptr || std::pair(shape.structure(), shape.mesh()) == told_) {
      messages.push_back(std::move(shape));
    } else {
      told_ = {shape.structure(), shape.mesh()};
      std::vector<v1::MapMesh> mesh = MeshMessages(*answer.canonical, shape.structure(),
                                                   shape.mesh(), demand_.geometry, kMeshPart);
      messages = WithMesh(std::move(shape), std::move(mesh), rpc::kMaxMessageBytes);
    }
    for (const v1::MapShape& each : messages) MORTISE_RETURN_IF_ERROR(CheckMessageSize(each));
    return messages;
  }

 private:
  absl::Status Open(const Request::Begin& begin) {
    MORTISE_ASSIGN_OR_RETURN(map_, interpolator_.loaded->Get(begin.name()));
    MORTISE_ASSIGN_OR_RETURN(demand_, ReadShapeDemand(map_->record, begin));
    return absl::OkStatus();
  }

  absl::Status Check(const Request::To& to) {
    MORTISE_RETURN_IF_ERROR(ReadPoint(map_->record, to.point()).status());
    if (last_ && to.sequence() <= *last_) {
      return InvalidField("sequence", "must be larger than that of the point before");
    }
    last_ = to.sequence();
    return absl::OkStatus();
  }

  const Interpolator& interpolator_;
  // Set by Begin:
  std::shared_ptr<const LoadedMap> map_;
  ShapeDemand demand_;
  // Of Take:
  std::optional<std::int64_t> last_;  // sequence
  // Of Answer:
  BlendedShape scratch_;
  std::pair<int, int> told_ = {-1, -1};  // structure and mesh that the client has
};

}  // namespace

std::unique_ptr<rpc::StreamReader<Request>> OpenShapeStream(
    const Interpolator& interpolator, std::shared_ptr<rpc::StreamWriter<v1::MapShape>> writer) {
  return rpc::FollowLatest<Request, v1::MapShape>(std::make_shared<FollowedMap>(interpolator),
                                                  std::move(writer));
}

}  // namespace mortise::interpolator
