// The standard health service of the gRPC door (grpc.health.v1.Health), for which nobody needs a
// token.
//
// gRPC's own would let a stranger watch as often as it likes, each time for ever. Here whoever
// answers is counted first (open_calls.h).
#pragma once

#include <grpcpp/generic/async_generic_service.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <set>
#include <string_view>

#include "gateway/admission/open_calls.h"

namespace mortise::gateway {

class HealthAnswers {
 public:
  // How long a Check may take, of which nothing but its own request is awaited.
  explicit HealthAnswers(std::chrono::milliseconds check_time = std::chrono::seconds(20))
      : check_time_(check_time) {}
  HealthAnswers(const HealthAnswers&) = delete;
  HealthAnswers& operator=(const HealthAnswers&) = delete;

  static bool IsCheck(std::string_view path);
  static bool IsWatch(std::string_view path);

  // From now on the door, whose name is empty, is SERVING; before it is NOT_SERVING.
  void SetServing();

  // From now on it is NOT_SERVING; who watches learns that, and its stream ends as UNAVAILABLE.
  void End();

  // Answer one call each, which keeps its place; they delete themselves. This must outlive them.
  grpc::ServerGenericBidiReactor* Check(grpc::CallbackServerContext& call,
                                        std::unique_ptr<OpenCalls::Place> place);
  grpc::ServerGenericBidiReactor* Watch(std::unique_ptr<OpenCalls::Place> place);

 private:
  class CheckAnswer;
  class WatchAnswer;

  const std::chrono::milliseconds check_time_;
  std::mutex mutex_;
  bool serving_ = false;             // guarded by mutex_
  bool ended_ = false;               // guarded by mutex_
  std::set<WatchAnswer*> watching_;  // guarded by mutex_
};

}  // namespace mortise::gateway
