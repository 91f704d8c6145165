// The addresses of host names, asked for without a thread that waits for each: names that nobody
// answers for delay no other.
//
// Asks as the system does: its hosts file, then its name servers.
#pragma once

#include <boost/asio/ip/address.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace mortise::gateway {

class NameResolver {
 public:
  using Addresses = absl::StatusOr<std::vector<boost::asio::ip::address>>;

  struct Options {
    absl::Duration timeout = absl::Seconds(5);  // for one name
    std::string name_servers = {};              // "ADDRESS:PORT,…"; the system's if empty
  };

  // INTERNAL if the system gives no sockets; INVALID_ARGUMENT if name_servers cannot be.
  static absl::StatusOr<std::unique_ptr<NameResolver>> Start(const Options& options);

  // Ends; names still asked for are answered with CANCELLED.
  virtual ~NameResolver() = default;

  // Calls `found` once, from the resolver's own thread, within the time-out: with at least one
  // address, or UNAVAILABLE with the reason. Thread safe.
  virtual void Resolve(const std::string& host, std::function<void(Addresses)> found) = 0;
};

}  // namespace mortise::gateway
