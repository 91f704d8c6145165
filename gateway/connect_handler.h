// Answers one call in the Connect protocol.
#pragma once

#include "gateway/http_context.h"

namespace mortise::gateway {

// Answers a POST to the path of `method`. False if the connection must be closed afterwards.
boost::asio::awaitable<bool> HandleConnect(HttpConnection& connection, const HttpContext& context,
                                           const MethodRoute& method, const HttpRequest& request);

// Answers a POST whose body was too large to be read, in the form that its content type asks for.
// The connection must be closed afterwards.
boost::asio::awaitable<void> RefuseTooLarge(HttpConnection& connection, const HttpRequest& request);

}  // namespace mortise::gateway
