// Page tokens of List methods, tied to what was asked for: the next page of one list is that of no
// other, and of no other filter.
//
// Handlers know positions only, such as the key of a page's last record; Endpoint::Query makes
// tokens of them. A token is a digest and the position, in base64 for URLs. The digest is over the
// position and the request without page_token and page_size, so that pages may differ in size, any
// replica takes any token, and none is kept. It finds mistakes; it keeps no secret.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/errors.h"

namespace google::protobuf {
class Message;
}

namespace mortise::rpc {

// Returns the token of a position in the list that `request` asks for; empty for an empty one,
// which is that of the last page.
std::string SealPageToken(const std::string& position, const google::protobuf::Message& request);

// Returns the position in a token; empty for an empty one, which asks for the first page.
// INVALID_ARGUMENT, "page_token", for what SealPageToken did not make for a request of this type
// and with these filters.
absl::StatusOr<std::string> OpenPageToken(const std::string& token,
                                          const google::protobuf::Message& request);

// function(request) as a StatusOr<Response>, where lists see positions and their callers tokens.
template <class Response, class Request, class Function>
absl::StatusOr<Response> WithPageTokens(const Request& request, const Function& function) {
  if constexpr (requires(Response response) {
                  request.page_token();
                  response.next_page_token();
                }) {
    Request opened = request;
    MORTISE_ASSIGN_OR_RETURN(*opened.mutable_page_token(),
                             OpenPageToken(request.page_token(), request));
    MORTISE_ASSIGN_OR_RETURN(Response response, function(opened));
    response.set_next_page_token(SealPageToken(response.next_page_token(), request));
    return response;
  } else {
    return function(request);
  }
}

}  // namespace mortise::rpc
