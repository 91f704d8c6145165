// STL, as text (solids of facets of three vertices) or binary (a number of facets of 50 bytes).
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/cleaned_file.h"
#include "common/mesh/scenes/cleaning/object_text.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/mesh/scenes/cleaning/stl_length.h"
#include "common/mesh/scenes/cleaning/text_lines.h"

namespace mortise::mesh {
namespace {

absl::StatusOr<CleanedFile> CleanBinary(std::string_view bytes) {
  const std::uint64_t count = DeclaredStlFacets(bytes);
  if (count == 0) return InvalidField("file", "has no facets");
  const std::uint64_t length = kStlHeader + kStlFacet * count;
  if (length > bytes.size()) {
    return InvalidField("file", absl::StrCat("declares ", count, " facets, but has room for ",
                                             (bytes.size() - kStlHeader) / kStlFacet));
  }
  if (count > kMaxSceneTriangles) return TooLarge("file", "2,000,000 triangles");
  CleanedFile cleaned;
  cleaned.extension = "stl";
  cleaned.bytes = bytes.substr(0, length);
  // The header may say "solid" or "COLOR=", which have a meaning to libassimp.
  std::fill_n(cleaned.bytes.begin(), kStlHeader - sizeof(std::uint32_t), '\0');
  if (length < bytes.size()) {
    cleaned.notes.push_back(
        absl::StrCat("Bytes behind the last facet, left out: ", bytes.size() - length, "."));
  }
  return cleaned;
}

// The facets of a text, one vertex after the other. Some programs write a facet in one line.
class StlText {
 public:
  absl::Status Add(std::string_view line, long number) {
    std::string_view rest = line;
    for (std::string_view word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
      if (word == "solid" || word == "endsolid") {
        // What follows is a name.
        if (word == "solid") text_.SetComponent(Trimmed(rest));
        return absl::OkStatus();
      }
      if (word == "facet" || word == "endfacet") MORTISE_RETURN_IF_ERROR(EndFacet(number));
      if (word == "vertex") MORTISE_RETURN_IF_ERROR(AddVertex(rest, number));
    }
    return absl::OkStatus();
  }

  absl::StatusOr<CleanedFile> Finish(long number) && {
    MORTISE_RETURN_IF_ERROR(EndFacet(number));
    return std::move(text_).Finish();
  }

 private:
  absl::Status AddVertex(std::string_view& line, long number) {
    std::vector<std::string_view> words = {TakeWord(line), TakeWord(line), TakeWord(line)};
    if (words.back().empty()) return FaultAtLine(number, "a vertex has too few coordinates");
    corners_.push_back(text_.vertices());
    return text_.AddVertex(words, number);
  }

  absl::Status EndFacet(long number) {
    if (corners_.empty()) return absl::OkStatus();
    if (corners_.size() != 3) {
      return FaultAtLine(number, absl::StrCat("a facet has ", corners_.size(), " vertices"));
    }
    return text_.AddFace(std::exchange(corners_, {}), number);
  }

  ObjectText text_;
  std::vector<std::int64_t> corners_;
};

absl::StatusOr<CleanedFile> CleanText(std::string_view bytes) {
  StlText text;
  TextLines lines(bytes);
  while (const std::optional<std::string_view> line = lines.Next()) {
    MORTISE_RETURN_IF_ERROR(text.Add(*line, lines.number()));
  }
  return std::move(text).Finish(lines.number());
}

}  // namespace

absl::StatusOr<CleanedFile> CleanStl(std::string_view bytes) {
  return IsTextStl(bytes) ? CleanText(bytes) : CleanBinary(bytes);
}

}  // namespace mortise::mesh
