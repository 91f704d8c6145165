// The `/metrics` page that Prometheus reads.
//
// Not prometheus-cpp's own exposer: the threads of the web server below it have stacks of 100 kB,
// and in a process that links OpenBLAS and Open CASCADE thread-local storage alone fills them.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace prometheus {
class Registry;
}

namespace mortise::rpc {

class MetricsEndpoint {
 public:
  // Serves what `registry` holds at http://`address`/metrics (host:port, port 0 for any free one)
  // from one thread of its own. A null registry serves an empty page. UNAVAILABLE naming the
  // address if it cannot be bound.
  static absl::StatusOr<std::unique_ptr<MetricsEndpoint>> Start(
      const std::string& address, std::shared_ptr<prometheus::Registry> registry);

  // Stops at once.
  virtual ~MetricsEndpoint() = default;

  // host:port as bound.
  virtual const std::string& address() const = 0;
};

}  // namespace mortise::rpc
