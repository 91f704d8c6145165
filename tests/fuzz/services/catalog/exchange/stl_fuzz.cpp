// Any bytes as an STL file, and as a shape if they are one: refused or taken, and nothing else.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "services/catalog/exchange/shape_import.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const auto imported =
      mortise::catalog::ShapeOfStl(std::string_view(reinterpret_cast<const char*>(data), size));
  if (imported.ok() && !(imported->shape.volume > 0)) std::abort();
  return 0;
}
