#include "common/mesh/scenes/cleaning/polygon_count.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"

namespace mortise::mesh {
namespace {

absl::Status TooManyCorners(std::int64_t face, std::string_view where, const std::string& what) {
  const std::string place =
      where.empty() ? "" : absl::StrCat(" (", absl::string_view(where.data(), where.size()), ")");
  return WithDetail(absl::ResourceExhaustedError(absl::StrCat(
                        "face ", face, place, " ", what,
                        ": divide such faces into smaller ones in the program that drew them")),
                    {"TOO_LARGE", "file"});
}

}  // namespace

absl::Status PolygonCount::Add(std::uint64_t corners, std::string_view where) {
  ++faces_;
  if (corners < 3) return absl::OkStatus();
  if (corners > static_cast<std::uint64_t>(kMaxSceneTriangles) ||
      triangles_ + static_cast<std::int64_t>(corners) - 2 > kMaxSceneTriangles) {
    return TooLarge("file", "2,000,000 triangles");
  }
  const auto count = static_cast<std::int64_t>(corners);
  triangles_ += count - 2;
  if (count > kMaxPolygonCorners) {
    return TooManyCorners(faces_, where,
                          absl::StrCat("has ", count, " corners, more than ", kMaxPolygonCorners));
  }
  if (count > 3) pairs_ += count * count;
  if (pairs_ > kMaxCornerPairs) {
    return TooManyCorners(faces_, where,
                          absl::StrCat("of ", count,
                                       " corners is one too many: together they take too long to "
                                       "divide into triangles"));
  }
  return absl::OkStatus();
}

}  // namespace mortise::mesh
