// A name server on loopback that says what a test wants, or nothing.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace mortise::gateway {

class NameServer {
 public:
  NameServer() : socket_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}) {
    thread_ = std::thread([this] { Serve(); });
  }

  ~NameServer() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    boost::asio::io_context io;
    boost::asio::ip::udp::socket waking(io, boost::asio::ip::udp::v4());
    waking.send_to(boost::asio::buffer("", 1), socket_.local_endpoint());
    thread_.join();
  }

  // For WebhookClientOptions and NameResolver::Options.
  std::string address() const {
    return "127.0.0.1:" + std::to_string(socket_.local_endpoint().port());
  }

  // The IPv4 addresses of a name from now on; there is no such name if there are none.
  void Say(const std::string& name, std::vector<std::string> addresses) {
    const std::lock_guard lock(mutex_);
    answers_[name] = std::move(addresses);
  }

  // Nothing is said to those who ask for this name from now on.
  void KeepSilent(const std::string& name) {
    const std::lock_guard lock(mutex_);
    answers_.erase(name);
  }

  // Waits until each of these names was asked for and not answered; false after ten seconds.
  bool WaitUntilAskedInVain(const std::set<std::string>& names) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10), [&] {
      return std::includes(in_vain_.begin(), in_vain_.end(), names.begin(), names.end());
    });
  }

 private:
  void Serve() {
    for (;;) {
      std::vector<std::uint8_t> message(512);
      boost::asio::ip::udp::endpoint peer;
      boost::system::error_code error;
      message.resize(socket_.receive_from(boost::asio::buffer(message), peer, 0, error));
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
      if (error || !Answer(message)) continue;
      socket_.send_to(boost::asio::buffer(message), peer, 0, error);
    }
  }

  // Makes the answer out of the question; false where nothing is to be said.
  bool Answer(std::vector<std::uint8_t>& message) {
    constexpr std::size_t kHeader = 12;
    std::string name;
    std::size_t at = kHeader;
    while (at < message.size() && message[at] != 0) {
      if (!name.empty()) name += '.';
      name.append(message.begin() + static_cast<long>(at + 1),
                  message.begin() + static_cast<long>(at + 1 + message[at]));
      at += message[at] + 1u;
    }
    if (at + 5 > message.size()) return false;
    const bool v4 = message[at + 2] == 1;
    message.resize(at + 5);  // header and question
    const auto found = answers_.find(name);
    if (found == answers_.end()) {
      in_vain_.insert(name);
      changed_.notify_all();
      return false;
    }
    const std::vector<std::string> addresses = v4 ? found->second : std::vector<std::string>{};
    message[2] = 0x85;  // an answer, with authority
    message[3] = found->second.empty() ? 0x83 : 0x80;
    message[7] = static_cast<std::uint8_t>(addresses.size());
    message[9] = message[11] = 0;  // nothing beside it
    for (const std::string& address : addresses) {
      const auto bytes = boost::asio::ip::make_address_v4(address).to_bytes();
      const std::uint8_t record[] = {0xc0, kHeader, 0, 1, 0, 1, 0, 0, 0, 0, 0, 4};
      message.insert(message.end(), std::begin(record), std::end(record));
      message.insert(message.end(), bytes.begin(), bytes.end());
    }
    return true;
  }

  boost::asio::io_context io_;
  boost::asio::ip::udp::socket socket_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::vector<std::string>> answers_;  // guarded by mutex_
  std::set<std::string> in_vain_;                            // guarded by mutex_
  bool stopping_ = false;                                    // guarded by mutex_
  std::thread thread_;
};

}  // namespace mortise::gateway
