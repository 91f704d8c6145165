// How binary STL is told from text.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

namespace mortise::mesh {

inline constexpr std::size_t kStlHeader = 84;  // bytes: a free text and the number of facets
inline constexpr std::size_t kStlFacet = 50;   // bytes

// Returns the number of facets that a binary STL file declares; 0 if it is too short to.
inline std::uint64_t DeclaredStlFacets(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() < kStlHeader) return 0;
  std::memcpy(&count, bytes.data() + kStlHeader - sizeof count, sizeof count);
  return count;
}

// Whether a file is STL as text. Some programs begin binary files, too, with "solid"; their length
// and their zero bytes tell them apart.
inline bool IsTextStl(std::string_view bytes) {
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || !bytes.substr(begin).starts_with("solid")) return false;
  const std::uint64_t facets = DeclaredStlFacets(bytes);
  if (facets > 0 && kStlHeader + kStlFacet * facets == bytes.size()) return false;
  return bytes.substr(0, 1024).find('\0') == std::string_view::npos;
}

}  // namespace mortise::mesh
