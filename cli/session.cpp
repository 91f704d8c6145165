#include "cli/session.h"

#include "common/base/errors.h"

namespace mortise::cli {

absl::StatusOr<GatewayClient*> Session::Client() {
  if (!client_) {
    MORTISE_ASSIGN_OR_RETURN(client_, GatewayClient::Connect(gateway));
  }
  return &*client_;
}

}  // namespace mortise::cli
