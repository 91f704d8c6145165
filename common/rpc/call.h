// One call being answered, as its handler sees it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/time/time.h"
#include "common/rpc/identity.h"

namespace mortise::rpc {

class CallState;

// A cheap handle; copies speak of the same call, and may outlive it. Thread safe.
class Call {
 public:
  explicit Call(std::shared_ptr<CallState> state) : state_(std::move(state)) {}

  // Returns who calls: subject, role, request id (the trace id).
  const Identity& identity() const;

  // "mortise.v1.CatalogService/GetItem".
  const std::string& method() const;

  // When the caller stops waiting; InfiniteFuture if never.
  absl::Time deadline() const;

  // Whether nobody waits for the answer any more: cancelled, or past the deadline.
  bool cancelled() const;

  // Runs `callback` on the handlers' threads, once, when the caller goes away, its deadline passes
  // or the server drains: long waits should then answer with what they have. At once if that is
  // past. Never after the call is answered.
  void OnStop(std::function<void()> callback) const;

  // Returns the identity as it came, for forwarding; empty in development.
  const std::string& signed_identity() const;

 private:
  std::shared_ptr<CallState> state_;
};

}  // namespace mortise::rpc
