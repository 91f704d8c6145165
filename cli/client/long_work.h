// Long work as commands do it: an operation is started, its name said at once, and its progress
// shown to its end. What the command has started it owns: a first Ctrl-C (or SIGTERM) cancels it,
// unless it is work that no client may stop by leaving; a second leaves at once, and says how to go
// on.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "cli/client/output.h"
#include "mortise/v1/operations.pb.h"

namespace grpc {
class ClientContext;
}

namespace mortise::cli {

// What becomes of an operation when the command that follows it is asked to end.
enum class WhenLeft {
  kIsCancelled,    // its result was for the command
  kGoesOn,         // the command only looks on
  kEndsWithHouse,  // so does the house, with all that runs in it
};

struct LongWork {
  WhenLeft when_left = WhenLeft::kIsCancelled;
  bool detach = false;  // starts it, and does not follow it
  // What stays of one that was cancelled and names no result.
  std::string what_stays = "it kept nothing";

  // The lines that tell how to go on with an operation that nobody follows; HowToGoOn if unset.
  std::function<std::string(const GatewayClient&, const v1::Operation&)> how_to_go_on = {};
};

// Makes the call that starts an operation.
using StartCall = std::function<absl::Status(grpc::ClientContext&, v1::Operation*)>;

// Returns "watch it with: mortise operations watch …" and how to cancel it, with this client's
// flags.
std::string HowToGoOn(const GatewayClient& client, const v1::Operation& operation);

// Starts an operation and follows it to its end; returns nothing if it is to run detached. FAILED
// ones give their error, CANCELLED ones are CANCELLED. Interrupted (ending_signals.h), with what
// became of it, if a signal came.
absl::StatusOr<std::optional<v1::Operation>> Run(const GatewayClient& client, const LongWork& work,
                                                 const StartCall& start, Output& output);

// Follows an operation that somebody has started to its end, as Run does.
absl::StatusOr<v1::Operation> Follow(const GatewayClient& client, const LongWork& work,
                                     const v1::Operation& operation, Output& output);

// Returns the operation as it stands. NOT_FOUND.
absl::StatusOr<v1::Operation> GetOperation(const GatewayClient& client, const std::string& name);

// Returns the name of the resource that an operation made, the best so far of one that was
// cancelled; empty if there is none.
std::string MadeBy(const v1::Operation& operation);

// Returns the result of an operation that has succeeded.
template <typename Result>
absl::StatusOr<Result> ResultOf(const v1::Operation& operation) {
  Result result;
  if (operation.result().UnpackTo(&result)) return result;
  return absl::InternalError("unexpected result of " + operation.name());
}

// Runs an operation, and returns its result; nothing if it is to run detached.
template <typename Result>
absl::StatusOr<std::optional<Result>> RunTo(const GatewayClient& client, const LongWork& work,
                                            const StartCall& start, Output& output) {
  const absl::StatusOr<std::optional<v1::Operation>> done = Run(client, work, start, output);
  if (!done.ok()) return done.status();
  if (!*done) return std::optional<Result>();
  absl::StatusOr<Result> result = ResultOf<Result>(**done);
  if (!result.ok()) return result.status();
  return std::optional<Result>(*std::move(result));
}

}  // namespace mortise::cli
