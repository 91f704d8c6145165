// The Connect protocol (connectrpc.com/docs/protocol): what its headers, bodies, envelopes and
// errors look like. Knows no sockets and no gRPC.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace mortise::gateway {

// Headers or trailers, names in lower case, in order, with repetitions.
using HeaderList = std::vector<std::pair<std::string, std::string>>;

// What one content type says of a request.
struct ConnectCodec {
  bool json = true;        // else serialised messages
  bool streaming = false;  // enveloped
};

// Returns the codec of "application/json", "application/proto", "application/connect+json" or
// "application/connect+proto", parameters such as charset ignored; nothing for others.
std::optional<ConnectCodec> ParseContentType(std::string_view content_type);

// Returns the content type of answers in this codec.
std::string_view ContentTypeOf(const ConnectCodec& codec);

// "not_found" of absl::StatusCode::kNotFound; "unknown" for codes out of range.
std::string_view ConnectCodeName(absl::StatusCode code);

// Returns the HTTP status of a unary error with this code.
int HttpStatusOf(absl::StatusCode code);

// `Connect-Timeout-Ms`: 1 to 10 digits. INVALID_ARGUMENT otherwise.
absl::StatusOr<absl::Duration> ParseTimeout(std::string_view text);

// One detail of an error: the full name of its message type, the message, serialised, and the same
// as JSON; empty where its type is not known.
struct ErrorDetailBytes {
  std::string type;
  std::string value;
  std::string json = {};
};

// A failure as Connect clients see it.
struct ConnectError {
  absl::StatusCode code = absl::StatusCode::kUnknown;
  std::string message;
  std::vector<ErrorDetailBytes> details;
};

// {"code":"invalid_argument","message":"…",
//  "reason":"FIELD_INVALID","fields":[{"field":"url","message":"…"}],
//  "details":[{"type":"…","value":"<base64, unpadded>","debug":{…}}]}
//
// `reason` and `fields` say without protobuf what is in the details of google.rpc.ErrorInfo and
// BadRequest; `debug` is each detail as JSON, as the protocol has it. All of them are left out
// where there is nothing to say.
std::string ErrorJson(const ConnectError& error);

// Returns the last message of a stream, without its envelope: {} or {"error":…,"metadata":{…}}.
std::string EndStreamJson(const std::optional<ConnectError>& error, const HeaderList& trailers);

inline constexpr uint8_t kCompressedFlag = 1;
inline constexpr uint8_t kEndStreamFlag = 2;
inline constexpr std::size_t kEnvelopeHeaderBytes = 5;

// Writes one byte of flags, four of length (big-endian), then the payload.
std::string Envelope(uint8_t flags, std::string_view payload);

// Returns the payloads of a body of envelopes; views into `body`. INVALID_ARGUMENT if it is cut
// short or has bytes left over, or an envelope has flags; RESOURCE_EXHAUSTED if one is longer than
// `limit`.
absl::StatusOr<std::vector<std::string_view>> SplitEnvelopes(std::string_view body,
                                                             std::size_t limit);

}  // namespace mortise::gateway
