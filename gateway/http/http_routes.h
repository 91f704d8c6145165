// Which answer belongs to which path and method of the HTTP door.
#pragma once

#include "gateway/http/http_context.h"

namespace mortise::gateway {

// Answers a request whose head has been read; its body is read where one is wanted. False if the
// connection must be closed afterwards.
boost::asio::awaitable<bool> HandleRequest(HttpConnection& connection, const HttpContext& context,
                                           HttpRequest& request);

// Answers bytes that are no request, or of one whose headers are too large. The connection must be
// closed afterwards.
boost::asio::awaitable<void> RefuseHead(HttpConnection& connection, HttpReadResult result);

}  // namespace mortise::gateway
