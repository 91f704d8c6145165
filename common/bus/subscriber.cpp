#include "common/bus/subscriber.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <zmq.hpp>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/bus/sockets.h"

namespace mortise::bus {
namespace {

std::string_view View(const zmq::message_t& frame) {
  return {static_cast<const char*>(frame.data()), frame.size()};
}

class SocketSubscriber final : public Subscriber {
 public:
  explicit SocketSubscriber(const SubscriberOptions& options)
      : socket_(context_, zmq::socket_type::sub) {
    socket_.set(zmq::sockopt::rcvhwm, options.queue_length);
    socket_.set(zmq::sockopt::linger, 0);
    KeepAlive(socket_);
    SecureClient(options.security, socket_);
    for (const std::string& topic : options.topics) socket_.set(zmq::sockopt::subscribe, topic);
    socket_.connect(options.endpoint);
  }

  absl::StatusOr<std::optional<Message>> Receive(absl::Duration timeout) override {
    const absl::Time deadline = absl::Now() + timeout;
    try {
      while (true) {
        if (ReceiveFrames()) {
          absl::StatusOr<Message> message =
              Decode(View(frames_[0]), View(frames_[1]), View(frames_[2]));
          if (message.ok()) return std::optional<Message>(*std::move(message));
          Log(LogLevel::kWarning, "a message of the bus was malformed",
              {{"error", std::string(message.status().message())}});
          continue;
        }
        if (interrupt_.Clear() || !WaitUntil(deadline)) return std::optional<Message>();
      }
    } catch (const zmq::error_t& error) {
      return PeerUnavailable("the bus", error.what());
    }
  }

  void Interrupt() override { interrupt_.Ring(); }

 private:
  // Takes the next message off the queue if there is one, into frames_.
  bool ReceiveFrames() {
    while (true) {
      std::size_t count = 0;
      bool more = true;
      while (more) {
        zmq::message_t& frame = frames_[std::min<std::size_t>(count, 2)];
        // Only the first frame can be missing: multipart messages arrive whole.
        if (!socket_.recv(frame, zmq::recv_flags::dontwait)) return false;
        more = frame.more();
        ++count;
      }
      if (count == 3) return true;
      Log(LogLevel::kWarning, "a message of the bus had the wrong number of parts", {});
    }
  }

  // Whether something may have come before the deadline.
  bool WaitUntil(absl::Time deadline) {
    const absl::Duration left = std::min(deadline - absl::Now(), absl::Hours(1));
    if (left <= absl::ZeroDuration()) return false;
    zmq::pollitem_t items[] = {{socket_.handle(), 0, ZMQ_POLLIN, 0},
                               {nullptr, interrupt_.descriptor(), ZMQ_POLLIN, 0}};
    zmq::poll(items, 2, std::chrono::milliseconds(absl::ToInt64Milliseconds(left) + 1));
    return true;
  }

  zmq::context_t context_;
  zmq::socket_t socket_;
  zmq::message_t frames_[3];
  WakeDescriptor interrupt_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Subscriber>> Subscriber::Connect(const SubscriberOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckSecurity(options.security, options.endpoint));
  if (options.queue_length < 1) return InvalidField("queue_length", "must be at least 1");
  try {
    return std::make_unique<SocketSubscriber>(options);
  } catch (const zmq::error_t& error) {
    return EndpointFailed(options.endpoint, error);
  }
}

}  // namespace mortise::bus
