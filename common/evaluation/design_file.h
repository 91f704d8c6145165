// The file with a design's shape and fields, which an evaluation names (docs/design-fields.md).
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/channel.h"

namespace grpc {
class Channel;
}

namespace mortise::evaluation {

// Which file.
struct DesignFile {
  std::string sha256;     // digest, 64 hexadecimal digits
  std::int64_t size = 0;  // bytes
};

// Returns the bytes of the file, which the simulator behind `channel` keeps for a day after the
// last result that named it. They have the digest. A simulator that is away is waited for as
// `retry` says, whose stop also ends what is under way (CANCELLED). NOT_FOUND where the file is
// gone: the design may be evaluated again; RESOURCE_EXHAUSTED where it is larger than such files
// can be (256 MiB); DATA_LOSS where it has another digest, twice; UNAVAILABLE.
absl::StatusOr<std::string> FetchDesignFile(const std::shared_ptr<grpc::Channel>& channel,
                                            const std::string& sha256, const rpc::Origin& origin,
                                            const rpc::RetryOptions& retry);

}  // namespace mortise::evaluation
