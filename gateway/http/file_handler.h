// Files by GET: methods that stream the pieces of one, as a browser, curl or a spreadsheet asks for
// it.
#pragma once

#include "gateway/contract/query.h"
#include "gateway/http/http_context.h"

namespace mortise::gateway {

// Answers GET and HEAD of a method that gives a file, whose request is in the target's parameters
// (query_message.h). The caller needs the method's role, and what it counts as a stream.
//
//   200, 206   the file or a range of it, named, typed and with its digest as strong ETag; a client
//              that reads slowly slows the service down
//   304        the client has it already (If-None-Match)
//   416        it has no such range
//   else       a failure as of any call
//
// A file whose service fails midway ends short of its announced length. False if the connection
// must be closed.
boost::asio::awaitable<bool> HandleFile(HttpConnection& connection, const HttpContext& context,
                                        const MethodRoute& method, const Target& target,
                                        const HttpRequest& request);

}  // namespace mortise::gateway
