// The small languages inside URLs and headers of the event streams.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::gateway {

// The path and the decoded parameters of a request target ("/events?streams=a,b&after=3").
struct Target {
  std::string authority;  // "127.0.0.1:7780" of a target with a scheme; empty for others
  std::string path;
  std::map<std::string, std::string> parameters;  // the last of a name counts
};

// Reads a target, which may also have a scheme and a host, as sent to proxies (RFC 9112, 3.2.2).
// INVALID_ARGUMENT for one that begins with neither these nor '/', is longer than 8 KiB, or has an
// escape by '%' that is malformed.
absl::StatusOr<Target> ParseTarget(std::string_view target);

// Whether an authority, as in `Host`, is a name of this machine for itself: localhost, 127.0.0.0/8
// or [::1], with or without a port. Another name may be of a page that a browser shows, which has
// had its own name point here to speak for itself (DNS rebinding).
bool IsLoopbackAuthority(std::string_view authority);

// "a,b,c" as a list; empty parts are left out.
std::vector<std::string> SplitList(std::string_view text);

// How far a reader of several streams has come: the last number seen of each.
using EventPosition = std::map<std::string, int64_t>;

// "catalog:12" or "catalog:12,pareto:5", as `id:` of server-sent events and `Last-Event-ID`.
// INVALID_ARGUMENT naming Last-Event-ID: other forms, a stream named twice, more than 64 streams.
absl::StatusOr<EventPosition> ParsePosition(std::string_view text);
std::string FormatPosition(const EventPosition& position);

// Returns a decimal number between -1 and 2^63-1; INVALID_ARGUMENT naming `field` otherwise.
absl::StatusOr<int64_t> ParseNumber(std::string_view text, std::string_view field);

}  // namespace mortise::gateway
