// Feeds bytes to the reader of Abaqus' and CalculiX' files: a mesh whose indices are in range, or a
// refusal.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/mesh/files/abaqus_reader.h"
#include "tests/fuzz/common/mesh/files/check_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  mortise::mesh::CheckRead(mortise::mesh::ReadAbaqus(bytes));
  return 0;
}
