// Puts PNG files side by side in one, each over its caption:
// picture_sheet SHEET [--columns COUNT] [--shrink TIMES] CAPTION=FILE…
// With --shrink each square of so many pixels becomes one.
#include <png.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/render/image.h"

namespace {

using namespace mortise;

struct Request {
  std::string file;
  int columns = 4;
  int shrink = 2;
  std::vector<std::string> pictures;  // "caption=file"
};

absl::StatusOr<render::Image> ReadPng(const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, file.c_str()) == 0) {
    return absl::InvalidArgumentError(absl::StrCat(file, ": ", png.message));
  }
  png.format = PNG_FORMAT_RGB;
  render::Image image(static_cast<int>(png.width), static_cast<int>(png.height), {1, 1, 1});
  if (png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr) == 0) {
    return absl::InvalidArgumentError(absl::StrCat(file, ": ", png.message));
  }
  return image;
}

// The mean colour of each square of `times` pixels.
render::Image Shrunk(const render::Image& image, int times) {
  render::Image small(image.width / times, image.height / times, {1, 1, 1});
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      render::Color sum;
      for (int i = 0; i < times * times; ++i) {
        const render::Color pixel = image.Get(x * times + i % times, y * times + i / times);
        sum.red += pixel.red;
        sum.green += pixel.green;
        sum.blue += pixel.blue;
      }
      const double share = 1.0 / (times * times);
      small.Set(x, y, {share * sum.red, share * sum.green, share * sum.blue});
    }
  }
  return small;
}

absl::Status MakeSheet(const Request& request) {
  std::vector<render::Image> pictures;
  std::vector<std::string> captions;
  for (const std::string& picture : request.pictures) {
    const std::size_t end = picture.rfind('=');
    if (end == std::string::npos) return absl::InvalidArgumentError("must be CAPTION=FILE");
    MORTISE_ASSIGN_OR_RETURN(const render::Image image, ReadPng(picture.substr(end + 1)));
    pictures.push_back(Shrunk(image, request.shrink));
    captions.push_back(picture.substr(0, end));
  }
  MORTISE_ASSIGN_OR_RETURN(const render::Image sheet,
                           render::ContactSheet(pictures, captions, request.columns));
  MORTISE_ASSIGN_OR_RETURN(const std::string png, render::EncodePng(sheet));
  return WriteFile(request.file, png);
}

}  // namespace

int main(int count, char** arguments) {
  Request request;
  bool understood = true;
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    int* const number = word == "--columns"  ? &request.columns
                        : word == "--shrink" ? &request.shrink
                                             : nullptr;
    if (number != nullptr) {
      understood =
          understood && ++i < count && absl::SimpleAtoi(arguments[i], number) && *number > 0;
    } else if (request.file.empty()) {
      request.file = word;
    } else {
      request.pictures.push_back(word);
    }
  }
  if (!understood || request.pictures.empty()) {
    std::cerr << "Usage: picture_sheet SHEET [--columns COUNT] [--shrink TIMES] CAPTION=FILE...\n";
    return 2;
  }
  const absl::Status made = MakeSheet(request);
  if (!made.ok()) std::cerr << made << "\n";
  return made.ok() ? 0 : 1;
}
