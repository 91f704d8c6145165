// Files by PUT and POST: methods that take the pieces of one.
#pragma once

#include <string_view>

#include "gateway/http/http_context.h"

namespace mortise::gateway {

// Whether a POST with this content type is the file itself, and no message, envelope or form.
bool IsFileItself(std::string_view content_type);

// Answers a PUT or POST of a file of any size to a method that takes one with its answer as JSON.
// The bytes are passed on as they come, and no faster than the service takes them; nothing of the
// file is kept here. The size must be said beforehand (Content-Length; else 411); `Content-Digest:
// sha-256=:…:` (RFC 9530) has the service check what came, and `Content-Encoding` is none that is
// taken here. How large a file may be is for the service to say, which refuses what is larger
// before it comes. False if the connection must be closed.
boost::asio::awaitable<bool> HandleUpload(HttpConnection& connection, const HttpContext& context,
                                          const MethodRoute& method, const HttpRequest& request);

}  // namespace mortise::gateway
