// Prometheus metrics of the calls of a process.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace prometheus {
class Registry;
}

namespace mortise::rpc {

class RequestMetrics {
 public:
  // `registry` may be null: nothing is counted.
  static std::unique_ptr<RequestMetrics> Create(std::shared_ptr<prometheus::Registry> registry);
  virtual ~RequestMetrics() = default;

  virtual void Begin() = 0;
  virtual void End(const std::string& method, absl::StatusCode code, absl::Duration time) = 0;
};

}  // namespace mortise::rpc
