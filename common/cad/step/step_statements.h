// Finds faults in the statements of a STEP file (ISO 10303-21) by the text alone. The kernel hangs
// over some of them, and reads others as another shape.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mortise::cad {

// Returns what is wrong with statements of the data section, "#12, line 40: …", in the order of the
// text; at most `limit`: - numbers that are none (NAN, 1.#INF, 1.2.3) or no finite ones (1E400), or
// larger than anything
//    that is drawn;
//  - points and directions of more than three numbers, as decimal commas make them;
//  - entities that refer to themselves, or that are defined twice, differently;
//  - lists in lists in lists without end.
// Reads any bytes; O(n log n) in the size of the text, with 24 bytes of memory an entity.
std::vector<std::string> StatementFaults(std::string_view text, std::size_t limit);

}  // namespace mortise::cad
