// What happens before and after every call, whatever its shape; used by the wrappers of handler.h.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "common/rpc/call.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/identity.h"

namespace google::protobuf {
class Message;
}
namespace grpc {
class CallbackServerContext;
}

namespace mortise::rpc {

// A method and its rule, read once from the proto option `mortise.v1.access`.
struct MethodInfo {
  std::string name;  // "mortise.v1.CatalogService/GetItem"
  Role role = Role::kNone;
  bool mutates = false;
  Lane lane = Lane::kCalls;
  absl::Status usable;  // why every call of it is refused (no rule, unknown to the proto), or OK
};

// Looks the rule of `service`/`method` up among the compiled-in protos.
MethodInfo FindMethod(std::string_view service, std::string_view method);

class CallState : public std::enable_shared_from_this<CallState> {
 public:
  // Copies what it needs from `context`.
  CallState(Dispatcher* dispatcher, const MethodInfo* method,
            const grpc::CallbackServerContext& context);

  // Counts the call in. RESOURCE_EXHAUSTED if there are too many.
  absl::Status Begin();

  // Verifies the identity and the role; then the deadline.
  absl::Status Admit();

  // Refuses numbers that are not finite and enum values the proto does not know, naming the field;
  // such a request with what `explanation` tells as well, if there is one.
  absl::Status CheckRequest(const google::protobuf::Message& request,
                            const std::function<absl::Status()>& explanation = nullptr) const;

  // Runs handler code with the call's trace id; an exception becomes INTERNAL and is logged.
  absl::Status RunGuarded(const std::function<absl::Status()>& work) const;

  // The caller has gone away, or its deadline has passed.
  void Cancel();

  // Runs the OnStop callbacks: after Cancel, or when the server drains.
  void Stop();

  // Counts the call out, with metrics and a log line. Only the first call counts.
  void End(const absl::Status& status);

  void OnStop(std::function<void()> callback);

  Dispatcher* dispatcher() const { return dispatcher_; }
  const MethodInfo& method() const { return *method_; }
  const Identity& identity() const { return identity_; }
  const std::string& signed_identity() const { return signed_identity_; }
  absl::Time deadline() const { return deadline_; }
  absl::Time begun_at() const { return begun_at_; }
  bool cancelled() const;

 private:
  absl::Status Authenticate();

  Dispatcher* const dispatcher_;
  const MethodInfo* const method_;
  const absl::Time begun_at_;
  absl::Time deadline_;
  std::string signed_identity_;
  std::string trace_id_;
  Identity identity_;  // set by Admit
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  bool stopped_ = false;                               // guarded by mutex_
  bool begun_ = false;                                 // guarded by mutex_
  bool ended_ = false;                                 // guarded by mutex_
  std::vector<std::function<void()>> stop_callbacks_;  // guarded by mutex_
};

}  // namespace mortise::rpc
