// Raster pictures in memory, contact sheets, and PNG files through libpng's simplified interface.
#include "common/render/image.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::render {
namespace {

constexpr std::size_t kPixelLimit = 100'000'000;

std::uint8_t ToByte(double channel) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0, 1.0) * 255));
}

// libpng keeps state that must be freed whichever way a function is left.
struct PngImage {
  png_image value{};
  PngImage() { value.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&value); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

void Paste(const Image& picture, int left, int top, Image& sheet) {
  for (int y = 0; y < picture.height; ++y) {
    std::memcpy(&sheet.pixels[3 * (static_cast<std::size_t>(top + y) * sheet.width + left)],
                &picture.pixels[3 * static_cast<std::size_t>(y) * picture.width],
                3 * static_cast<std::size_t>(picture.width));
  }
}

}  // namespace

Image::Image(int width_in, int height_in, const Color& fill)
    : width(width_in), height(height_in), pixels(3 * std::size_t(width_in) * height_in) {
  const std::uint8_t bytes[3] = {ToByte(fill.red), ToByte(fill.green), ToByte(fill.blue)};
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = bytes[i % 3];
}

void Image::Set(int x, int y, const Color& color) {
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  std::uint8_t* pixel = &pixels[3 * (static_cast<std::size_t>(y) * width + x)];
  pixel[0] = ToByte(color.red);
  pixel[1] = ToByte(color.green);
  pixel[2] = ToByte(color.blue);
}

Color Image::Get(int x, int y) const {
  const std::uint8_t* pixel = &pixels[3 * (static_cast<std::size_t>(y) * width + x)];
  return {pixel[0] / 255.0, pixel[1] / 255.0, pixel[2] / 255.0};
}

absl::StatusOr<std::string> EncodePng(const Image& image) {
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() != 3 * std::size_t(image.width) * image.height) {
    return InvalidField("image", "the image is empty or its pixels do not match its size");
  }
  PngImage png;
  png.value.width = image.width;
  png.value.height = image.height;
  png.value.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (!png_image_write_get_memory_size(png.value, size, 0, image.pixels.data(), 0, nullptr)) {
    return absl::InternalError(absl::StrCat("PNG: ", png.value.message));
  }
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png.value, bytes.data(), &size, 0, image.pixels.data(), 0,
                                 nullptr)) {
    return absl::InternalError(absl::StrCat("PNG: ", png.value.message));
  }
  bytes.resize(size);
  return bytes;
}

absl::StatusOr<Image> ContactSheet(const std::vector<Image>& pictures,
                                   const std::vector<std::string>& captions, int columns) {
  if (pictures.empty()) return InvalidField("pictures", "a contact sheet needs a picture");
  if (captions.size() != pictures.size()) {
    return InvalidField("captions", "there must be one caption for each picture");
  }
  if (columns < 1) return InvalidField("columns", "must be at least 1");
  constexpr int kGap = 16;
  constexpr double kText = 11;
  const bool captioned = std::any_of(captions.begin(), captions.end(),
                                     [](const std::string& text) { return !text.empty(); });
  const int caption_height = captioned ? 26 : 0;
  int cell_width = 0, cell_height = 0;
  for (const Image& picture : pictures) {
    cell_width = std::max(cell_width, picture.width);
    cell_height = std::max(cell_height, picture.height);
  }
  const int count = static_cast<int>(pictures.size());
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;
  const std::int64_t width = std::int64_t{columns} * (cell_width + kGap) + kGap;
  const std::int64_t height = std::int64_t{rows} * (cell_height + caption_height + kGap) + kGap;
  if (std::size_t(width) * std::size_t(height) > kPixelLimit) {
    return TooLarge("contact sheet", "100 million pixels");
  }
  Image sheet(static_cast<int>(width), static_cast<int>(height), {1, 1, 1});
  for (int i = 0; i < count; ++i) {
    const int left = kGap + (i % columns) * (cell_width + kGap);
    const int top = kGap + (i / columns) * (cell_height + caption_height + kGap);
    Paste(pictures[i], left + (cell_width - pictures[i].width) / 2, top, sheet);
    const double text_width = TextWidth(kText, captions[i]);
    DrawText(sheet, left + std::max(0.0, (cell_width - text_width) / 2), top + cell_height + 8,
             kText, {0.15, 0.16, 0.2}, captions[i]);
  }
  return sheet;
}

}  // namespace mortise::render
