#include "common/bus/publisher.h"

#include <mutex>
#include <zmq.hpp>

#include "common/base/errors.h"
#include "common/bus/sockets.h"

namespace mortise::bus {
namespace {

class SocketPublisher final : public Publisher {
 public:
  explicit SocketPublisher(const PublisherOptions& options)
      : socket_(context_, zmq::socket_type::pub) {
    socket_.set(zmq::sockopt::sndhwm, options.queue_length);
    socket_.set(zmq::sockopt::linger, 200);  // ms; what is still queued at the end
    KeepAlive(socket_);
    SecureClient(options.security, socket_);
    socket_.connect(options.endpoint);
  }

  absl::Status Publish(const Event& event) override { return Send(Encode(event)); }
  absl::Status Publish(const Heartbeat& heartbeat) override { return Send(Encode(heartbeat)); }

 private:
  absl::Status Send(const Frames& frames) {
    std::lock_guard lock(mutex_);
    try {
      // A publisher socket never blocks: it drops whole messages.
      socket_.send(zmq::buffer(frames.topic), zmq::send_flags::sndmore);
      socket_.send(zmq::buffer(frames.header), zmq::send_flags::sndmore);
      socket_.send(zmq::buffer(frames.payload), zmq::send_flags::none);
    } catch (const zmq::error_t& error) {
      return PeerUnavailable("the bus", error.what());
    }
    return absl::OkStatus();
  }

  zmq::context_t context_;
  std::mutex mutex_;
  zmq::socket_t socket_;  // guarded by mutex_
};

}  // namespace

absl::StatusOr<std::unique_ptr<Publisher>> Publisher::Connect(const PublisherOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckSecurity(options.security, options.endpoint));
  if (options.queue_length < 1) return InvalidField("queue_length", "must be at least 1");
  try {
    return std::make_unique<SocketPublisher>(options);
  } catch (const zmq::error_t& error) {
    return EndpointFailed(options.endpoint, error);
  }
}

}  // namespace mortise::bus
