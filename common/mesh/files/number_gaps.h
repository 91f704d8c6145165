// Finds which numbers are missing where things are numbered through.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mortise::mesh {

// Says which numbers are missing of numbers that go on in one step but for some, in whatever order
// they are: "run from 1 to 6 by 1, and 1 is missing". Returns nothing if none is missing, or there
// is no telling.
std::string NumberGaps(std::vector<std::int64_t> numbers);

}  // namespace mortise::mesh
