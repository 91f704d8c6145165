// Answers one call in the Connect protocol.
#pragma once

#include "gateway/http/http_context.h"

namespace mortise::gateway {

// Answers a POST to the path of `method`, whose body is read once the caller is known and allowed
// to call. False if the connection must be closed afterwards.
boost::asio::awaitable<bool> HandleConnect(HttpConnection& connection, const HttpContext& context,
                                           const MethodRoute& method, HttpRequest& request);

}  // namespace mortise::gateway
