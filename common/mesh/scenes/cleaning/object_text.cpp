#include "common/mesh/scenes/cleaning/object_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/string_views.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/mesh/scenes/cleaning/text_lines.h"

namespace mortise::mesh {
absl::Status FaultAtLine(long line, std::string_view what) {
  return InvalidField("file", absl::StrCat("line ", line, ": ", AbslView(what)));
}

std::string TooManyComponents(std::size_t count) {
  return absl::StrCat("The file has ", count, " groups or objects, more than ", kMaxSceneComponents,
                      ": they were taken as one.");
}

absl::Status ObjectText::AddVertex(const std::vector<std::string_view>& words, long line) {
  vertex_text_ += 'v';
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::optional<double> number = DecimalNumber(words[i]);
    if (!number) {
      return FaultAtLine(line,
                         absl::StrCat("\"", AbslView(words[i].substr(0, 20)), "\" is no number"));
    }
    const auto single = static_cast<float>(*number);
    if (!std::isfinite(single)) {
      return FaultAtLine(line, std::isfinite(*number) ? "a coordinate is larger than 3.4e38"
                                                      : "a coordinate is not finite");
    }
    if (i == 3 && single == 0) return FaultAtLine(line, "the fourth coordinate is 0");
    // Written anew: libassimp takes ".5" for no number and passes over the vertex.
    std::array<char, 32> digits;
    const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), single);
    vertex_text_.append(" ").append(digits.data(), written.ptr);
  }
  vertex_text_ += '\n';
  ++vertices_;
  return absl::OkStatus();
}

absl::Status ObjectText::AddFace(const std::vector<std::int64_t>& vertices, long line) {
  MORTISE_RETURN_IF_ERROR(polygons_.Add(vertices.size(), absl::StrCat("line ", line)));
  if (vertices.size() < 3) {
    ++incomplete_;
    return absl::OkStatus();
  }
  if (face_texts_.empty()) SetComponent("");
  std::string& text = face_texts_[component_];
  text += 'f';
  for (const std::int64_t vertex : vertices) {
    if (vertex < 0) return FaultAtLine(line, "a face names a vertex before the first");
    if (vertex > highest_) {
      highest_ = vertex;
      highest_line_ = line;
    }
    absl::StrAppend(&text, " ", vertex + 1);
  }
  text += '\n';
  return absl::OkStatus();
}

void ObjectText::SetComponent(std::string_view name) {
  const auto [entry, is_new] = component_of_.try_emplace(std::string(name), names_.size());
  component_ = entry->second;
  if (!is_new) return;
  names_.emplace_back(name);
  face_texts_.emplace_back();
}

absl::StatusOr<CleanedFile> ObjectText::Finish() && {
  if (polygons_.triangles() == 0) {
    return InvalidField("file",
                        vertices_ > 0 ? "has points, but no faces between them" : "has no faces");
  }
  if (highest_ >= vertices_) {
    return FaultAtLine(highest_line_,
                       absl::StrCat("a face names vertex ", highest_ + 1, " of ", vertices_));
  }
  CleanedFile cleaned;
  cleaned.extension = "obj";
  cleaned.bytes = std::move(vertex_text_);
  // libassimp compares every object with all before it.
  const auto count = static_cast<std::size_t>(
      std::count_if(face_texts_.begin(), face_texts_.end(),
                    [](const std::string& text) { return !text.empty(); }));
  const bool are_too_many = count > kMaxSceneComponents;
  if (are_too_many) {
    cleaned.notes.push_back(TooManyComponents(count));
    names_.clear();
  }
  for (std::size_t i = 0; i < face_texts_.size(); ++i) {
    if (face_texts_[i].empty()) continue;
    if (!are_too_many) absl::StrAppend(&cleaned.bytes, "o c", i, "\n");
    cleaned.bytes += std::exchange(face_texts_[i], {});
  }
  if (incomplete_ > 0) {
    cleaned.notes.push_back(
        absl::StrCat("Faces of fewer than three corners, left out: ", incomplete_, "."));
  }
  cleaned.names = std::move(names_);
  return cleaned;
}

}  // namespace mortise::mesh
