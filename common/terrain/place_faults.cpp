#include "common/terrain/place_faults.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"

namespace mortise::terrain {
namespace {

std::string Interval(const std::string& from, const std::string& to) {
  return absl::StrCat(from, " to ", to, " m");
}

}  // namespace

absl::Status NotKnownAt(const Rectangle& known, double x, double y) {
  const std::vector<std::string> along_x = ComparedNumbers({known.from_x, known.to_x, x});
  const std::vector<std::string> along_y = ComparedNumbers({known.from_y, known.to_y, y});
  return absl::OutOfRangeError(absl::StrCat(
      "is known for x ", Interval(along_x[0], along_x[1]), " and y ",
      Interval(along_y[0], along_y[1]), ", not at x = ", along_x[2], " m, y = ", along_y[2], " m"));
}

absl::Status NotKnownUnder(const Rectangle& known, const Rectangle& rectangle) {
  const std::vector<std::string> along_x =
      ComparedNumbers({known.from_x, known.to_x, rectangle.from_x, rectangle.to_x});
  const std::vector<std::string> along_y =
      ComparedNumbers({known.from_y, known.to_y, rectangle.from_y, rectangle.to_y});
  return absl::OutOfRangeError(
      absl::StrCat("is known for x ", Interval(along_x[0], along_x[1]), " and y ",
                   Interval(along_y[0], along_y[1]), ", not under all of x ",
                   Interval(along_x[2], along_x[3]), ", y ", Interval(along_y[2], along_y[3])));
}

absl::Status HoleAt(double x, double y) {
  return absl::OutOfRangeError(absl::StrCat("has a hole at x = ", x, " m, y = ", y, " m"));
}

}  // namespace mortise::terrain
