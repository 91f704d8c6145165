#include "tests/e2e/http_post.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace mortise::e2e {
namespace {

// Whether an answer has come to the end that its Content-Length tells.
bool IsWhole(const std::string& answer) {
  constexpr std::string_view kName = "\r\ncontent-length:";
  const std::size_t end = answer.find("\r\n\r\n");
  if (end == std::string::npos) return false;
  const std::string head = absl::AsciiStrToLower(answer.substr(0, end));
  const std::size_t at = head.find(kName);
  if (at == std::string::npos) return false;
  const int length = std::atoi(head.c_str() + at + kName.size());
  return answer.size() >= end + 4 + static_cast<std::size_t>(length);
}

// A connection to a port of this machine, closed on destruction.
class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{10, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool Send(std::string_view bytes) const {
    while (connected_ && !bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return connected_;
  }

  // An answer with its headers.
  std::string ReadAnswer() const {
    std::string answer;
    char buffer[4096];
    while (!IsWhole(answer)) {
      const ssize_t got = ::recv(socket_, buffer, sizeof(buffer), 0);
      if (got <= 0) break;
      answer.append(buffer, static_cast<std::size_t>(got));
    }
    return answer;
  }

 private:
  const int socket_;
  bool connected_ = false;
};

}  // namespace

HttpAnswer Post(const std::string& address, const std::string& path,
                const std::string& content_type, const std::string& body,
                std::optional<std::size_t> announced) {
  const Connection connection(std::atoi(address.substr(address.rfind(':') + 1).c_str()));
  const std::string head =
      absl::StrCat("POST ", path, " HTTP/1.1\r\nHost: ", address,
                   "\r\nConnection: close\r\nContent-Type: ", content_type,
                   "\r\nContent-Length: ", announced.value_or(body.size()), "\r\n\r\n");
  HttpAnswer answer;
  if (!connection.Send(head + body)) return answer;
  const std::string all = connection.ReadAnswer();
  const std::size_t space = all.find(' ');
  const std::size_t end = all.find("\r\n\r\n");
  if (space == std::string::npos || end == std::string::npos) return answer;
  answer.status = std::atoi(all.c_str() + space + 1);
  answer.body = all.substr(end + 4);
  return answer;
}

}  // namespace mortise::e2e
