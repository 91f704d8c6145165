#include "services/fabplanner/service/bridge_methods.h"

#include <cstdint>
#include <utility>

#include "common/base/errors.h"

namespace mortise::fabplanner::methods {
namespace {

// The messages of one bridge's stream.
class BridgeStream : public rpc::StreamReader<v1::BridgeMessage> {
 public:
  BridgeStream(ShopFloor* floor, ShopFloor::Writer writer)
      : floor_(floor), writer_(std::move(writer)) {}

  absl::Status OnMessage(const v1::BridgeMessage& message) override {
    if (attachment_ != 0) return floor_->Receive(attachment_, message);
    if (!message.has_hello()) return InvalidField("message", "the first must be a hello");
    MORTISE_ASSIGN_OR_RETURN(attachment_, floor_->Attach(message.hello(), writer_));
    return absl::OkStatus();
  }

  void OnEnd() override {
    if (attachment_ == 0) {
      // It may also have sent a first message that is none.
      writer_->Finish(InvalidField("message", "no hello was sent"));
      return;
    }
    floor_->Detach(attachment_);
    writer_->Finish(absl::OkStatus());
  }

 private:
  ShopFloor* const floor_;
  const ShopFloor::Writer writer_;
  int64_t attachment_ = 0;
};

}  // namespace

absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::BridgeMessage>>> AttachBridge(
    const FabPlanner& planner, const rpc::Call&, ShopFloor::Writer writer) {
  return std::make_unique<BridgeStream>(planner.floor, std::move(writer));
}

absl::StatusOr<v1::ListBridgesResponse> ListBridges(const FabPlanner& planner, const rpc::Call&,
                                                    const v1::ListBridgesRequest&) {
  v1::ListBridgesResponse answer;
  for (v1::ListBridgesResponse::Bridge& bridge : planner.floor->Bridges()) {
    *answer.add_bridges() = std::move(bridge);
  }
  return answer;
}

}  // namespace mortise::fabplanner::methods
