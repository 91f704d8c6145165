// From the outbox to the bus: numbers committed events without gaps, then publishes them.
//
// The relay is one thread in a service. It takes the store's right to number events; of several
// replicas on one PostgreSQL store one gets it, the others stand by and take over, in a new epoch,
// when it dies. If the process dies between numbering and publishing, the heartbeat of the next
// relay tells subscribers what they lack, and they fetch it by number: so nothing is lost.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "common/bus/publisher.h"
#include "common/store/store.h"

namespace mortise::bus {

struct OutboxRelayOptions {
  std::string stream = {};  // the service's name
  absl::Duration heartbeat = absl::Seconds(1);
  // How long a commit of another process (which cannot wake this one) waits at most.
  absl::Duration poll = absl::Milliseconds(100);
  int batch = 2000;  // events numbered in one transaction
};

class OutboxRelay {
 public:
  // Starts the thread. `store` and `publisher` must outlive it.
  static std::unique_ptr<OutboxRelay> Start(const OutboxRelayOptions& options, store::Store* store,
                                            Publisher* publisher);

  // Stops the thread after the batch in hand.
  virtual ~OutboxRelay() = default;

  // Whether this relay holds the right to number (false: standing by).
  virtual bool active() const = 0;

  // Returns the number of the last event it published; 0 if none.
  virtual int64_t published() const = 0;

  // Waits until it has published event `number`; false if that took longer than `timeout`.
  virtual bool WaitForPublished(int64_t number, absl::Duration timeout) = 0;
};

}  // namespace mortise::bus
