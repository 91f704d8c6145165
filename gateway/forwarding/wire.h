// Small pieces shared by both doors: byte buffers, reserved metadata, flow control.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace mortise::gateway {

// Makes one copy each way; an empty string is a buffer of one empty slice, which gRPC wants.
grpc::ByteBuffer ToByteBuffer(std::string_view bytes);
std::string ToString(const grpc::ByteBuffer& buffer);

// Whether a client's metadata is meant for this gateway or for the transport, and therefore not
// passed on: tokens, identities (only the gateway makes those), hop-by-hop headers.
bool IsReservedMetadata(std::string_view key);

// Whether gRPC takes this as metadata. It ends the process over anything else, so what comes from
// outside is checked first.
bool IsLegalMetadata(std::string_view key, std::string_view value);

// How much of a caller's metadata is passed on, counted as HTTP/2 does: names, values and 32 bytes
// for each. A service takes 16 KiB, of which the identity and the transport need some.
inline constexpr std::size_t kMaxMetadataBytes = 8 * 1024;

class PassedMetadata {
 public:
  void Add(std::string_view key, std::string_view value);

  // Fails with RESOURCE_EXHAUSTED, METADATA_TOO_LARGE if there is more than kMaxMetadataBytes;
  // names the largest. `what` is what the caller calls them: "metadata", "headers".
  absl::Status Check(std::string_view what) const;

 private:
  std::size_t bytes_ = 0;
  std::map<std::string, std::size_t, std::less<>> by_key_;
};

// Fixed flow-control windows for both sides. gRPC would otherwise let them grow with the measured
// rate: a fast stream past a slow reader would then hold tens of megabytes here.
void SetFlowControl(const std::function<void(const char* name, int value)>& set);

}  // namespace mortise::gateway
