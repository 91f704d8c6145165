// Uses libpng's simplified interface.
#include "tests/support/png_image.h"

#include <png.h>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::testing {
namespace {

// libpng keeps state that must be freed whichever way a function is left.
struct PngImage {
  png_image value{};
  PngImage() { value.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&value); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

}  // namespace

absl::StatusOr<render::Image> DecodePng(const std::string& bytes) {
  PngImage png;
  if (!png_image_begin_read_from_memory(&png.value, bytes.data(), bytes.size())) {
    return InvalidField("png", absl::StrCat("not a PNG file: ", png.value.message));
  }
  png.value.format = PNG_FORMAT_RGB;
  render::Image image;
  image.width = static_cast<int>(png.value.width);
  image.height = static_cast<int>(png.value.height);
  image.pixels.resize(3 * std::size_t(png.value.width) * png.value.height);
  const png_color white{255, 255, 255};
  if (!png_image_finish_read(&png.value, &white, image.pixels.data(), 0, nullptr)) {
    return InvalidField("png", absl::StrCat("broken PNG file: ", png.value.message));
  }
  return image;
}

}  // namespace mortise::testing
