#include "common/terrain/height_field.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::terrain {
namespace {

absl::Status CheckRectangle(const Rectangle& rectangle) {
  const auto ends_before = [](double from, double to) {
    return !(to - from >= -HeightField::kBorder);
  };
  if (!ends_before(rectangle.from_x, rectangle.to_x) &&
      !ends_before(rectangle.from_y, rectangle.to_y)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "is asked for under a rectangle that ends before it begins: x ", rectangle.from_x, " to ",
      rectangle.to_x, " m, y ", rectangle.from_y, " to ", rectangle.to_y, " m"));
}

}  // namespace

absl::StatusOr<RectangleValue> HeightField::LowestUnder(const Rectangle& rectangle) const {
  MORTISE_RETURN_IF_ERROR(CheckRectangle(rectangle));
  MORTISE_ASSIGN_OR_RETURN(RectangleValue largest, LargestUnder(rectangle, -1));
  return RectangleValue{-largest.value, -largest.gradient};
}

absl::StatusOr<RectangleValue> HeightField::HighestUnder(const Rectangle& rectangle) const {
  MORTISE_RETURN_IF_ERROR(CheckRectangle(rectangle));
  return LargestUnder(rectangle, 1);
}

}  // namespace mortise::terrain
