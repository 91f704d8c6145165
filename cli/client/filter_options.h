// The flags that say which resources of a list are wanted, by what every resource has: said once
// for all commands that list.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "cli/client/command_flags.h"
#include "mortise/v1/types.pb.h"

namespace mortise::cli {

// What the flags were given, as it was typed; what is empty was not given.
struct FilterOptions {
  std::string external_id = {};
  std::vector<std::string> labels = {};  // KEY=VALUE, or KEY for any value
  std::string creator = {};              // "ada" or "users/ada"
  std::string since = {};
  std::string before = {};
};

// Declares the flags of a command that lists: --external-id, --label, --creator, --since and
// --before.
void AddFilterOptions(CommandFlags& flags, FilterOptions& options);

// Returns the time that a person means by a text:
// - "2026-11-26", "2026-11-26T20:25", "2026-11-26T20:25:30.5", with "Z" or "+01:00" behind it or
//   else in `zone` (ISO 8601); a date is its first moment;
// - "90s", "15min", "2h", "7d" or "3w": so long before `now`.
// INVALID_ARGUMENT naming `field` with these forms for others, and for what is before the year 1
// or after 9999.
absl::StatusOr<absl::Time> ParseTime(const std::string& text, const std::string& field,
                                     absl::Time now, absl::TimeZone zone);

// Returns the filter as lists take it. INVALID_ARGUMENT naming the flag at fault.
absl::StatusOr<v1::ResourceFilter> ParseFilter(const FilterOptions& options, absl::Time now,
                                               absl::TimeZone zone);

// The same at this moment, with times in the zone of this machine.
absl::StatusOr<v1::ResourceFilter> ParseFilter(const FilterOptions& options);

}  // namespace mortise::cli
