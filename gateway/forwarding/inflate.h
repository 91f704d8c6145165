// Compressed messages of callers, expanded within the limit of messages.
#pragma once

#include "absl/status/statusor.h"

namespace grpc {
class ByteBuffer;
}

namespace mortise::gateway {

// Expands `message` if it is compressed with gzip, as gRPC's clients may, and tells whether it was.
// It is recognised by its first two bytes, which no serialised message begins with (they would be a
// field of a wire type that there is not). RESOURCE_EXHAUSTED, TOO_LARGE as soon as it is over
// rpc::kMaxMessageBytes, and no more than that is ever held; INVALID_ARGUMENT naming `request` if
// it is damaged.
absl::StatusOr<bool> Inflate(grpc::ByteBuffer& message);

}  // namespace mortise::gateway
