#include "cli/client/session.h"

#include "common/base/errors.h"

namespace mortise::cli {

absl::StatusOr<GatewayClient*> Session::Client() {
  if (!client_) {
    MORTISE_ASSIGN_OR_RETURN(client_, GatewayClient::Connect(gateway));
  }
  return &*client_;
}

LongWork Session::Work(bool detach) const {
  return {.when_left = house_ends_too ? WhenLeft::kEndsWithHouse : WhenLeft::kIsCancelled,
          .detach = detach};
}

}  // namespace mortise::cli
