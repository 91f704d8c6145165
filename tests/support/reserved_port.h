// A port on loopback that stays the test's own, for a server that must be known before it runs, or
// that comes back where it was.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace mortise::testing {

// Holds the port by a bound socket that does not listen: the system gives the port to nobody who
// asks for any, while a server that asks for this one, with SO_REUSEADDR as servers do, gets it.
class ReservedPort {
 public:
  ReservedPort() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    sockaddr_in where = {};
    where.sin_family = AF_INET;
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(where);
    auto* generic = reinterpret_cast<sockaddr*>(&where);
    if (::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) != 0 ||
        ::bind(socket_, generic, size) != 0 || ::getsockname(socket_, generic, &size) != 0) {
      const int error = errno;
      ::close(socket_);
      throw std::system_error(error, std::generic_category(), "reserving a port");
    }
    address_ = "127.0.0.1:" + std::to_string(ntohs(where.sin_port));
  }
  ~ReservedPort() { ::close(socket_); }
  ReservedPort(const ReservedPort&) = delete;
  ReservedPort& operator=(const ReservedPort&) = delete;

  const std::string& address() const { return address_; }  // "127.0.0.1:port"
  std::string port() const { return address_.substr(address_.rfind(':') + 1); }

 private:
  const int socket_;
  std::string address_;
};

}  // namespace mortise::testing
