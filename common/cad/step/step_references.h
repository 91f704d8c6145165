// Finds references in the text of a STEP file (ISO 10303-21) to entities that it does not have. The
// kernel reads such a file without them, as another shape, or falls over it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace mortise::cad {

// An entity, "#123", that is used and is not there.
struct MissingEntity {
  std::uint64_t number = 0;
  std::uint64_t user = 0;  // the first entity that uses it; 0 where no entity does

  bool operator==(const MissingEntity&) const = default;
};

// Returns each missing entity once, in the order of their numbers; at most `limit` of them. All
// data sections count together, as they may refer to each other. It reads any bytes, in O(n log n)
// of the size of the text, with 8 bytes of memory an entity.
std::vector<MissingEntity> MissingEntities(std::string_view text, std::size_t limit);

}  // namespace mortise::cad
