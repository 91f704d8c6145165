// Pages of the simulator's lists.
#pragma once

#include <cstddef>

#include "absl/status/statusor.h"
#include "common/base/errors.h"

namespace mortise::simulator {

// Pages end here, full or not: messages hold 4 MiB, and one entry less than 3 MB.
inline constexpr std::size_t kPageBytes = 1'000'000;

// How many entries a page has that was asked for so many; INVALID_ARGUMENT naming "page_size".
inline absl::StatusOr<int> PageSize(int asked) {
  if (asked == 0) return 100;
  if (asked < 1 || asked > 1000) return InvalidField("page_size", "must be within 1 to 1000");
  return asked;
}

}  // namespace mortise::simulator
