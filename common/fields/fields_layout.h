// Numbers of the file's layout, which writer and reader share. Private to this folder.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mortise::fields {

// Values are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little);

inline constexpr std::string_view kMagic = "MORTISEF";
inline constexpr std::size_t kHeaderSize = 64;
inline constexpr std::size_t kVersionAt = 8;    // u32
inline constexpr std::size_t kSectionsAt = 12;  // u32, how many
inline constexpr std::size_t kSizeAt = 16;      // u64, of the file
inline constexpr std::size_t kChecksumAt = 24;  // 32 bytes, of all after the header
inline constexpr std::size_t kChecksumSize = 32;
inline constexpr std::size_t kTableEntrySize = 24;  // u32 kind, u32 0, u64 offset, u64 size
inline constexpr std::size_t kAlignment = 8;        // of every section, text and array

enum class SectionKind : std::uint32_t {
  kNodes = 1,
  kTetrahedra = 2,
  kTriangles = 3,
  kParts = 4,
  kRegions = 5,
  kControlPoints = 6,
  kPaths = 7,
  kField = 8,        // as many as there are fields
  kControlWays = 9,  // once if there are any, else not
};

// How the numbers of an array are written.
enum class Encoding : std::uint32_t { kDouble = 1, kSteps = 2, kFloat = 3 };

inline constexpr std::uint32_t kNone = 0xffffffff;  // where there is no node, or no part

inline constexpr std::size_t Aligned(std::size_t size) {
  return (size + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace mortise::fields
