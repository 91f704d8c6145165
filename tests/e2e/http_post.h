// An HTTP request as bytes on a socket.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace mortise::e2e {

struct HttpAnswer {
  int status = 0;  // 0 if none came
  std::string body;
};

// Posts `body` to host:port and reads the answer, waiting 10 s at most for each of its pieces.
// `announced` is the Content-Length to claim instead of the body's.
HttpAnswer Post(const std::string& address, const std::string& path,
                const std::string& content_type, const std::string& body,
                std::optional<std::size_t> announced = std::nullopt);

}  // namespace mortise::e2e
