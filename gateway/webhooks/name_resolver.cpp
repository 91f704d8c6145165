#include "gateway/webhooks/name_resolver.h"

#include <ares.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

using boost::asio::ip::address;
using std::chrono::steady_clock;

constexpr int kFirstTryMilliseconds = 1500;  // doubled for the second
constexpr int kTries = 2;

struct ChannelDeleter {
  void operator()(ares_channeldata* channel) const { ares_destroy(channel); }
};

std::vector<address> AddressesOf(const ares_addrinfo& found) {
  std::vector<address> addresses;
  for (const ares_addrinfo_node* node = found.nodes; node != nullptr; node = node->ai_next) {
    if (node->ai_family == AF_INET) {
      const auto& v4 = *reinterpret_cast<const sockaddr_in*>(node->ai_addr);
      addresses.emplace_back(boost::asio::ip::address_v4(ntohl(v4.sin_addr.s_addr)));
    } else if (node->ai_family == AF_INET6) {
      const auto& v6 = *reinterpret_cast<const sockaddr_in6*>(node->ai_addr);
      boost::asio::ip::address_v6::bytes_type bytes;
      std::memcpy(bytes.data(), &v6.sin6_addr, bytes.size());
      addresses.emplace_back(boost::asio::ip::address_v6(bytes, v6.sin6_scope_id));
    }
  }
  return addresses;
}

class AresResolver final : public NameResolver {
 public:
  explicit AresResolver(const Options& options) : options_(options) {}

  ~AresResolver() override {
    if (thread_.joinable()) {
      {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
      }
      WakeUp();
      thread_.join();
    }
    // Before the channel ends, which calls back what is still asked as if it could not be found.
    for (Question& question : asked_) Answer(question, absl::CancelledError());
    for (Question& question : waiting_) Answer(question, absl::CancelledError());
    channel_.reset();
    if (wake_ >= 0) ::close(wake_);
  }

  absl::Status Begin() {
    MORTISE_RETURN_IF_ERROR(OpenChannel());
    wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (wake_ < 0) return absl::InternalError(std::strerror(errno));
    thread_ = std::thread([this] { Run(); });
    return absl::OkStatus();
  }

  void Resolve(const std::string& host, std::function<void(Addresses)> found) override {
    {
      const std::lock_guard lock(mutex_);
      waiting_.push_back({host, std::move(found), {}, this});
    }
    WakeUp();
  }

 private:
  struct Question {
    std::string host;
    std::function<void(Addresses)> found;  // empty once it was called
    steady_clock::time_point deadline;
    AresResolver* resolver = nullptr;
  };

  static void Answer(Question& question, Addresses addresses) {
    if (!question.found) return;
    std::exchange(question.found, nullptr)(std::move(addresses));
  }

  void WakeUp() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof(one));
  }

  // A channel with the system's present settings.
  absl::Status OpenChannel() {
    ares_options options{};
    options.timeout = kFirstTryMilliseconds;
    options.tries = kTries;
    options.sock_state_cb = [](void* self, ares_socket_t socket, int readable, int writable) {
      static_cast<AresResolver*>(self)->Watch(socket, readable != 0, writable != 0);
    };
    options.sock_state_cb_data = this;
    ares_channel channel = nullptr;
    const int begun = ares_init_options(
        &channel, &options, ARES_OPT_TIMEOUTMS | ARES_OPT_TRIES | ARES_OPT_SOCK_STATE_CB);
    if (begun != ARES_SUCCESS) return absl::InternalError(ares_strerror(begun));
    channel_.reset(channel);
    if (!options_.name_servers.empty() &&
        ares_set_servers_ports_csv(channel, options_.name_servers.c_str()) != ARES_SUCCESS) {
      return InvalidField("name_servers", "must be addresses with ports, separated by commas");
    }
    return absl::OkStatus();
  }

  void Watch(ares_socket_t socket, bool readable, bool writable) {
    const int events = (readable ? POLLIN : 0) | (writable ? POLLOUT : 0);
    if (events == 0) {
      sockets_.erase(socket);
    } else {
      sockets_[socket] = static_cast<short>(events);
    }
  }

  void Run() {
    while (AskWaiting()) {
      std::vector<pollfd> events = {{wake_, POLLIN, 0}};
      for (const auto& [socket, wanted] : sockets_) events.push_back({socket, wanted, 0});
      ::poll(events.data(), events.size(), Patience());
      std::uint64_t count = 0;
      [[maybe_unused]] const ssize_t read = ::read(wake_, &count, sizeof(count));
      for (std::size_t i = 1; i < events.size(); ++i) {
        const bool readable = (events[i].revents & (POLLIN | POLLERR | POLLHUP)) != 0;
        const bool writable = (events[i].revents & (POLLOUT | POLLERR)) != 0;
        if (!readable && !writable) continue;
        ares_process_fd(channel_.get(), readable ? events[i].fd : ARES_SOCKET_BAD,
                        writable ? events[i].fd : ARES_SOCKET_BAD);
      }
      ares_process_fd(channel_.get(), ARES_SOCKET_BAD, ARES_SOCKET_BAD);  // what timed out
      Expire();
    }
  }

  // Returns false when the resolver ends.
  bool AskWaiting() {
    std::deque<Question> waiting;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return false;
      waiting.swap(waiting_);
    }
    // What the system's settings say may have changed since; where that fails the old channel does.
    if (asked_.empty() && !waiting.empty()) (void)OpenChannel();
    for (Question& question : waiting) {
      Question& asked = asked_.emplace_back(std::move(question));
      asked.deadline = steady_clock::now() + absl::ToChronoMilliseconds(options_.timeout);
      ares_addrinfo_hints hints{};
      hints.ai_family = AF_UNSPEC;
      ares_getaddrinfo(channel_.get(), asked.host.c_str(), nullptr, &hints, TakeAnswer, &asked);
    }
    return true;
  }

  static void TakeAnswer(void* asked, int status, int /*timeouts*/, ares_addrinfo* found) {
    Question& question = *static_cast<Question*>(asked);
    if (found != nullptr) {
      std::vector<address> addresses = AddressesOf(*found);
      ares_freeaddrinfo(found);
      if (!addresses.empty()) Answer(question, std::move(addresses));
    }
    Answer(question,
           absl::UnavailableError(ares_strerror(status == ARES_SUCCESS ? ARES_ENODATA : status)));
    std::list<Question>& all = question.resolver->asked_;
    all.erase(std::find_if(all.begin(), all.end(),
                           [&](const Question& other) { return &other == &question; }));
  }

  // Milliseconds until something times out; without end if nothing is asked.
  int Patience() const {
    if (asked_.empty()) return -1;
    timeval next{};
    timeval most{1, 0};
    ares_timeout(channel_.get(), &most, &next);
    auto patience = std::chrono::milliseconds(next.tv_sec * 1000 + next.tv_usec / 1000 + 1);
    for (const Question& question : asked_) {
      if (!question.found) continue;
      const auto left = question.deadline - steady_clock::now();
      patience = std::min(patience, std::chrono::ceil<std::chrono::milliseconds>(left));
    }
    return static_cast<int>(std::max<std::int64_t>(0, patience.count()));
  }

  // Who asked waits no longer; what the name servers say later is of no use.
  void Expire() {
    const auto now = steady_clock::now();
    for (Question& question : asked_) {
      if (now >= question.deadline) Answer(question, absl::UnavailableError("nobody answers"));
    }
  }

  const Options options_;
  int wake_ = -1;  // eventfd
  std::mutex mutex_;
  std::deque<Question> waiting_;  // guarded by mutex_
  bool stopping_ = false;         // guarded by mutex_
  // Only the thread uses these. Questions stay where they are: c-ares keeps their addresses.
  std::list<Question> asked_;
  std::map<int, short> sockets_;
  std::unique_ptr<ares_channeldata, ChannelDeleter> channel_;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<NameResolver>> NameResolver::Start(const Options& options) {
  auto resolver = std::make_unique<AresResolver>(options);
  MORTISE_RETURN_IF_ERROR(resolver->Begin());
  return std::unique_ptr<NameResolver>(std::move(resolver));
}

}  // namespace mortise::gateway
