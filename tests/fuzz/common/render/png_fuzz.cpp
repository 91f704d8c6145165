// Feeds bytes to the PNG reader: it must refuse or return an image whose size fits its pixels.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/render/image.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const auto image = mortise::render::DecodePng(bytes);
  if (!image.ok()) return 0;
  if (image->pixels.size() != 3 * std::size_t(image->width) * image->height) std::abort();
  if (!mortise::render::EncodePng(*image).ok()) std::abort();
  return 0;
}
