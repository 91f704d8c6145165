// Pages of other origins that may call this gateway (the Fetch standard's CORS protocol).
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "gateway/contract/connect_protocol.h"

namespace mortise::gateway {

// The origins that were stated. A page of one gets leave for each request by itself; none gets
// leave to have a browser send what it has stored for this gateway (credentials), as callers show
// tokens.
class CrossOrigins {
 public:
  CrossOrigins() = default;  // none

  // Reads origins as browsers send them: "https://plm.example", "http://localhost:5173".
  // INVALID_ARGUMENT naming `cors-origin` for anything else, "*" and "null" among it: with either,
  // any page would be one.
  static absl::StatusOr<CrossOrigins> Parse(const std::vector<std::string>& origins);

  bool Allows(std::string_view origin) const { return origins_.count(std::string(origin)) > 0; }

  // Returns what every answer to a request with this `Origin` carries; `Vary` alone for one that is
  // not allowed, nothing where no origin was stated.
  HeaderList HeadersFor(std::string_view origin) const;

  // Returns what the answer to a preflight carries besides: leave for the methods of this door, and
  // for the headers that are asked for, as far as they are names. Nothing for one that is not
  // allowed.
  HeaderList PreflightHeaders(std::string_view origin, std::string_view asked_headers) const;

 private:
  std::set<std::string> origins_;
};

}  // namespace mortise::gateway
