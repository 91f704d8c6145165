// Feeds bytes to the reader of mesh files: a scene whose indices are in range and whose coordinates
// are finite, or a refusal. libassimp gets only what the cleaning of each format lets through.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/mesh/scenes/scene_encoding.h"
#include "common/mesh/scenes/scene_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto scene = mortise::mesh::ImportScene(bytes, "");
  if (scene.ok() && !mortise::mesh::DecodeScene(mortise::mesh::EncodeScene(*scene)).ok()) {
    std::abort();
  }
  return 0;
}
