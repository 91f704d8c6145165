// What a PLY file says of itself before its data.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::mesh {

struct PlyType {
  std::string_view name;     // as libassimp reads it
  std::string_view synonym;  // "int8" of "char"
  std::size_t size;          // bytes
};

struct PlyProperty {
  std::string name;
  const PlyType* type = nullptr;
  const PlyType* count_type = nullptr;  // of a list, the type of its length

  bool IsList() const { return count_type != nullptr; }
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;

  bool HasLists() const;
  std::size_t Size() const;  // bytes of one that has no lists
  // Returns the index of the first property with one of these names, or -1.
  int Find(std::string_view name, std::string_view synonym = "") const;
};

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;  // up to and with "face": what follows is not read
  std::size_t length = 0;            // bytes, to where the data begin
  long lines = 0;
};

// The name of the property that holds the corners of a face, in either of its spellings.
inline constexpr std::string_view kPlyCorners = "vertex_indices";
inline constexpr std::string_view kPlyCornersSynonym = "vertex_index";

// INVALID_ARGUMENT, "file": a header that is damaged or never ends; no vertices with x, y and z, or
// no faces with vertex_indices behind them, or several of either; triangle strips.
absl::StatusOr<PlyHeader> ReadPlyHeader(std::string_view bytes);

}  // namespace mortise::mesh
