// Whole bodies of requests: their room, their time, and gzip.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gateway/admission/budget.h"
#include "gateway/http/http_context.h"

namespace mortise::gateway {

// Why a body could not be read; OK for a client that is gone, too, whom nobody can tell.
absl::Status BodyFailure(HttpReadResult result);

// Tells a client whose body could not be read why; the connection must then be closed.
boost::asio::awaitable<void> WriteBodyFailure(HttpConnection& connection, HttpReadResult result);

// A body that somebody may send. Bodies above kSmallBodyBytes count, while this is kept, by
// subject.
class RequestBody {
 public:
  // What can be said before the body comes. RESOURCE_EXHAUSTED: too large, or no room for large
  // ones now. UNIMPLEMENTED naming an encoding other than gzip.
  static absl::StatusOr<RequestBody> Expect(const HttpConnection& connection,
                                            const HttpContext& context, const HttpRequest& request,
                                            const std::string& subject);

  // Reads it into the request. Once.
  boost::asio::awaitable<HttpReadResult> Read(HttpConnection& connection, HttpRequest& request);

  // Returns what was read, expanded where the request says that it is compressed: within the limit
  // of bodies. Fails as ExpandGzip, and with RESOURCE_EXHAUSTED if there is no room for it.
  absl::StatusOr<std::string> Take(HttpRequest& request);

 private:
  RequestBody(Budget* bodies, std::string subject, bool compressed)
      : bodies_(bodies), subject_(std::move(subject)), compressed_(compressed) {}

  // Whether there is room for so many bytes of a body, or was already.
  bool HasRoom(std::size_t bytes, std::size_t wanted);

  Budget* bodies_;
  std::string subject_;
  bool compressed_;
  std::unique_ptr<Budget::Share> share_;
};

}  // namespace mortise::gateway
