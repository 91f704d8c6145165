#include "common/bus/broker.h"

#include <set>
#include <thread>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/bus/sockets.h"

namespace mortise::bus {
namespace {

constexpr int kQueueLength = 200000;  // messages, for each peer

// Answers ZeroMQ's question who may connect (ZAP, RFC 27): the keys on the list. Must exist before
// the sockets it guards are bound.
class AllowList {
 public:
  AllowList(zmq::context_t& context, const BrokerSecurity& security)
      : socket_(context, zmq::socket_type::rep) {
    for (const std::string& key : security.allowed_clients) {
      std::string bytes(32, '\0');
      zmq_z85_decode(reinterpret_cast<uint8_t*>(bytes.data()), key.c_str());
      allowed_.insert(bytes);
    }
    socket_.set(zmq::sockopt::linger, 0);
    socket_.bind("inproc://zeromq.zap.01");
    thread_ = std::thread([this] { Answer(); });
  }

  ~AllowList() {
    stop_.Ring();
    thread_.join();
  }

 private:
  void Answer() {
    try {
      while (true) {
        zmq::pollitem_t items[] = {{socket_.handle(), 0, ZMQ_POLLIN, 0},
                                   {nullptr, stop_.descriptor(), ZMQ_POLLIN, 0}};
        zmq::poll(items, 2, std::chrono::milliseconds(-1));
        if (items[1].revents != 0) return;
        AnswerOne();
      }
    } catch (const zmq::error_t& error) {
      // Without this thread no client is admitted: the safe side.
      Log(LogLevel::kError, "the bus's allow-list stopped", {{"error", error.what()}});
    }
  }

  // Request: version, request id, domain, address, identity, mechanism, credentials.
  // Reply: version, request id, status, text, user id, metadata.
  void AnswerOne() {
    std::vector<std::string> request;
    bool more = true;
    while (more) {
      zmq::message_t frame;
      if (!socket_.recv(frame, zmq::recv_flags::none)) return;
      request.push_back(frame.to_string());
      more = frame.more();
    }
    const bool allowed = request.size() == 7 && request[0] == "1.0" && request[5] == "CURVE" &&
                         allowed_.contains(request[6]);
    if (!allowed) {
      Log(LogLevel::kWarning, "a client of the bus was refused",
          {{"address", request.size() > 3 ? request[3] : ""}});
    }
    const std::string id = request.size() > 1 ? request[1] : "";
    const std::vector<std::string> reply = {
        "1.0", id, allowed ? "200" : "400", allowed ? "OK" : "unknown key", "", ""};
    for (std::size_t i = 0; i < reply.size(); ++i) {
      socket_.send(zmq::buffer(reply[i]),
                   i + 1 < reply.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    }
  }

  zmq::socket_t socket_;
  std::set<std::string> allowed_;  // keys as 32 bytes
  WakeDescriptor stop_;
  std::thread thread_;
};

class ProxyBroker final : public Broker {
 public:
  explicit ProxyBroker(const BrokerOptions& options)
      : allow_list_(options.security.keys ? std::make_unique<AllowList>(context_, options.security)
                                          : nullptr),
        publishers_(context_, zmq::socket_type::xsub),
        subscribers_(context_, zmq::socket_type::xpub),
        control_(context_, zmq::socket_type::pair),
        controlled_(context_, zmq::socket_type::pair) {
    for (zmq::socket_t* socket : {&publishers_, &subscribers_}) {
      socket->set(zmq::sockopt::linger, 0);
      socket->set(zmq::sockopt::sndhwm, kQueueLength);
      socket->set(zmq::sockopt::rcvhwm, kQueueLength);
      KeepAlive(*socket);
      socket->set(zmq::sockopt::handshake_ivl,
                  static_cast<int>(absl::ToInt64Milliseconds(options.handshake_time)));
      SecureServer(options.security, *socket);
    }
    control_.set(zmq::sockopt::linger, 0);
    control_.bind("inproc://control");
    controlled_.connect("inproc://control");
  }

  ~ProxyBroker() override {
    if (!thread_.joinable()) return;
    control_.send(zmq::str_buffer("TERMINATE"), zmq::send_flags::none);
    thread_.join();
  }

  void Bind(const std::string& publisher_endpoint, const std::string& subscriber_endpoint) {
    publishers_.bind(publisher_endpoint);
    publisher_endpoint_ = publishers_.get(zmq::sockopt::last_endpoint);
    subscribers_.bind(subscriber_endpoint);
    subscriber_endpoint_ = subscribers_.get(zmq::sockopt::last_endpoint);
    thread_ = std::thread([this] { Forward(); });
  }

  std::string publisher_endpoint() const override { return publisher_endpoint_; }
  std::string subscriber_endpoint() const override { return subscriber_endpoint_; }

 private:
  void Forward() {
    try {
      zmq::proxy_steerable(publishers_, subscribers_, zmq::socket_ref(), controlled_);
    } catch (const zmq::error_t& error) {
      Log(LogLevel::kError, "the bus stopped", {{"error", error.what()}});
    }
  }

  zmq::context_t context_;
  std::unique_ptr<AllowList> allow_list_;  // null if plain
  zmq::socket_t publishers_;
  zmq::socket_t subscribers_;
  zmq::socket_t control_;     // this end is the destructor's
  zmq::socket_t controlled_;  // this end is the thread's
  std::string publisher_endpoint_;
  std::string subscriber_endpoint_;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Broker>> Broker::Start(const BrokerOptions& options) {
  MORTISE_RETURN_IF_ERROR(
      CheckSecurity(options.security, {options.publisher_endpoint, options.subscriber_endpoint}));
  try {
    auto broker = std::make_unique<ProxyBroker>(options);
    broker->Bind(options.publisher_endpoint, options.subscriber_endpoint);
    return broker;
  } catch (const zmq::error_t& error) {
    return EndpointFailed(options.publisher_endpoint + ", " + options.subscriber_endpoint, error);
  }
}

}  // namespace mortise::bus
