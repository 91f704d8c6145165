#include "cli/files/ground_mesh.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/files/csv_table.h"

namespace mortise::cli {
namespace {

using Words = std::vector<std::string>;

constexpr std::size_t kStlHeader = 84;  // bytes, with the count
constexpr std::size_t kStlFacet = 50;

// Calls `take` with the words of each line and its number; ends with the first failure, of which
// the line is named.
template <typename Take>
absl::Status ForEachLine(std::string_view text, const std::string& origin, Take take) {
  int line = 0;
  for (const absl::string_view row :
       absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
    ++line;
    const Words words = absl::StrSplit(row, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty()) continue;
    const absl::Status taken = take(words);
    if (!taken.ok()) {
      return InvalidField(absl::StrCat(origin, ": line ", line), std::string(taken.message()));
    }
  }
  return absl::OkStatus();
}

// Three numbers after the first word.
absl::StatusOr<std::array<double, 3>> PointIn(const Words& words) {
  if (words.size() < 4) return absl::InvalidArgumentError("a vertex has three numbers");
  std::array<double, 3> point{};
  for (std::size_t i = 0; i < 3; ++i) {
    MORTISE_ASSIGN_OR_RETURN(point[i], parametric::ParseCsvNumber(words[i + 1]));
  }
  return point;
}

// The vertex that "7/1/3" or "-1" names, of those before.
absl::StatusOr<int> VertexOf(const std::string& word, int count) {
  int number = 0;
  if (!absl::SimpleAtoi(word.substr(0, word.find('/')), &number)) {
    return absl::InvalidArgumentError(absl::StrCat("'", word, "' names no vertex"));
  }
  const int index = number < 0 ? count + number : number - 1;
  if (index >= 0 && index < count) return index;
  return absl::InvalidArgumentError(
      absl::StrCat("there is no vertex ", number, "; ", count, " stand before"));
}

absl::Status AddFace(const Words& words, v1::HeightTriangles& triangles) {
  std::vector<int> corners;
  for (std::size_t i = 1; i < words.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(const int corner, VertexOf(words[i], triangles.vertices_size() / 3));
    corners.push_back(corner);
  }
  if (corners.size() < 3) return absl::InvalidArgumentError("a face has at least three corners");
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    for (const int corner : {corners[0], corners[i], corners[i + 1]}) {
      triangles.add_triangles(corner);
    }
  }
  return absl::OkStatus();
}

// Collects corners, three a triangle.
class CornerCollector {
 public:
  void Add(const std::array<double, 3>& corner) {
    const auto [found, is_new] = indices_.emplace(corner, static_cast<int>(indices_.size()));
    if (is_new) triangles_.mutable_vertices()->Add(corner.begin(), corner.end());
    triangles_.add_triangles(found->second);
  }

  v1::HeightTriangles Take() { return std::move(triangles_); }

 private:
  std::map<std::array<double, 3>, int> indices_;
  v1::HeightTriangles triangles_;
};

bool IsBinaryStl(std::string_view bytes) {
  if (bytes.size() < kStlHeader) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kStlHeader - sizeof(count), sizeof(count));
  return bytes.size() == kStlHeader + kStlFacet * count;
}

v1::HeightTriangles ReadBinaryStl(std::string_view bytes) {
  CornerCollector corners;
  for (std::size_t facet = kStlHeader; facet < bytes.size(); facet += kStlFacet) {
    std::array<float, 12> numbers{};  // of the normal and three corners
    std::memcpy(numbers.data(), bytes.data() + facet, sizeof(numbers));
    for (std::size_t i = 3; i < numbers.size(); i += 3) {
      corners.Add({numbers[i], numbers[i + 1], numbers[i + 2]});
    }
  }
  return corners.Take();
}

absl::Status CheckFaces(const v1::HeightTriangles& triangles, const std::string& origin) {
  if (triangles.triangles_size() > 0) return absl::OkStatus();
  return InvalidField(origin, "has no triangles");
}

}  // namespace

absl::StatusOr<v1::HeightTriangles> ParseObjGround(std::string_view text,
                                                   const std::string& origin) {
  v1::HeightTriangles triangles;
  MORTISE_RETURN_IF_ERROR(ForEachLine(text, origin, [&](const Words& words) -> absl::Status {
    if (words[0] == "f") return AddFace(words, triangles);
    if (words[0] != "v") return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(const auto point, PointIn(words));
    triangles.mutable_vertices()->Add(point.begin(), point.end());
    return absl::OkStatus();
  }));
  MORTISE_RETURN_IF_ERROR(CheckFaces(triangles, origin));
  return triangles;
}

absl::StatusOr<v1::HeightTriangles> ParseStlGround(std::string_view bytes,
                                                   const std::string& origin) {
  if (IsBinaryStl(bytes)) {
    v1::HeightTriangles triangles = ReadBinaryStl(bytes);
    MORTISE_RETURN_IF_ERROR(CheckFaces(triangles, origin));
    return triangles;
  }
  CornerCollector corners;
  MORTISE_RETURN_IF_ERROR(ForEachLine(bytes, origin, [&](const Words& words) -> absl::Status {
    if (words[0] != "vertex") return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(const auto point, PointIn(words));
    corners.Add(point);
    return absl::OkStatus();
  }));
  v1::HeightTriangles triangles = corners.Take();
  MORTISE_RETURN_IF_ERROR(CheckFaces(triangles, origin));
  if (triangles.triangles_size() % 3 == 0) return triangles;
  return InvalidField(origin, "ends within a triangle");
}

}  // namespace mortise::cli
