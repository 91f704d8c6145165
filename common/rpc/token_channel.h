// Channels to the gateway for processes that have a bearer token instead of identity keys: workers
// on machines that the house does not own.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/channel_security.h"

namespace grpc {
class Channel;
}

namespace mortise::rpc {

// Returns a channel as MakeChannel's whose calls carry the token in `token_file` (at most 64 KiB,
// white space around it is left out). The file is read for each call, so that a new token needs no
// restart; while it has none, calls are UNAVAILABLE, naming the file.
//
// INVALID_ARGUMENT naming the flag if there is no `security.authority`, for tokens travel in TLS
// only; NOT_FOUND if there is no such file; else fails as MakeClientCredentials does.
absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeTokenChannel(
    const std::string& address, const ChannelSecurity& security,
    const std::filesystem::path& token_file);

}  // namespace mortise::rpc
