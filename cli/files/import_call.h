// A call that imports an assembly, as commands wait for it: with what it does and how far it is on
// the line of progress, and cancelled by Ctrl-C.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "cli/client/output.h"

namespace mortise::cli {

struct ImportCall {
  std::string request_id;   // of the request, by which its events are known
  std::string name;         // of the assembly
  std::int64_t before = 0;  // its latest revision before; 0 if there is none
  double seconds = 60;      // until the call is given up
  // Makes the call.
  std::function<absl::Status(grpc::ClientContext&)> make;
  // Returns the latest revision as it is now.
  std::function<absl::StatusOr<std::int64_t>()> present;
};

// Makes the call, and shows what the catalog tells of it meanwhile (events "assembly.importing").
// Interrupted (ending_signals.h) after a first Ctrl-C or SIGTERM, with what became of the assembly;
// a second one leaves at once. Fails as the call does.
absl::Status MakeWatched(const ImportCall& call, const GatewayClient& client, Output& output);

}  // namespace mortise::cli
