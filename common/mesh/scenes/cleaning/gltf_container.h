// The two parts of a glTF file: its JSON document, and the bytes of all its buffers in one.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::mesh {

struct GltfContainer {
  nlohmann::json document;
  std::string data;                 // all buffers, one behind the other
  std::vector<std::size_t> offset;  // of each buffer in `data`
  std::vector<std::size_t> length;  // of each buffer
};

// Takes a GLB, or the JSON of a glTF, apart. INVALID_ARGUMENT, "file": it is not glTF 2, its chunks
// or its JSON are damaged, values lie more than kMaxSceneDepth deep in each other, a buffer is in a
// file of its own or shorter than it says.
absl::StatusOr<GltfContainer> OpenGlb(std::string_view bytes);
absl::StatusOr<GltfContainer> OpenGltf(std::string_view json);

// Returns a GLB of a document and the bytes of its one buffer.
std::string WriteGlb(const nlohmann::json& document, std::string_view data);

// Returns the whole number at `key` of an object, or `absent` if it has none. INVALID_ARGUMENT,
// "file", for another value, and one beyond 32 bits.
absl::StatusOr<std::uint64_t> GltfNumber(const nlohmann::json& object, const char* key,
                                         std::uint64_t absent);

// Returns the array at `key` of an object; an empty one if there is none.
const nlohmann::json& GltfArray(const nlohmann::json& object, const char* key);

}  // namespace mortise::mesh
