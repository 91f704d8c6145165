// Server-sent events: the house's events, and the states of an operation.
#pragma once

#include "gateway/contract/query.h"
#include "gateway/http/http_context.h"

namespace mortise::gateway {

// GET /events?streams=&after=&types=. Every event has the id "stream:number", listing all streams
// that are followed, so that `Last-Event-ID` resumes each where it was.
boost::asio::awaitable<bool> HandleEvents(HttpConnection& connection, const HttpContext& context,
                                          const Target& target, const HttpRequest& request);

// GET /operations/{service}/{id}/watch. Ends when the operation is done.
boost::asio::awaitable<bool> HandleOperationWatch(HttpConnection& connection,
                                                  const HttpContext& context,
                                                  const std::string& operation,
                                                  const HttpRequest& request);

}  // namespace mortise::gateway
