// Wavefront OBJ: vertices, faces, objects and groups. Materials, normals, textures, lines, points
// and free-form curves are passed over.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/cleaned_file.h"
#include "common/mesh/scenes/cleaning/object_text.h"
#include "common/mesh/scenes/cleaning/text_lines.h"

namespace mortise::mesh {
namespace {

absl::Status AddObjVertex(std::string_view line, long number, ObjectText& text) {
  std::vector<std::string_view> words;
  for (std::string_view word = TakeWord(line); !word.empty(); word = TakeWord(line)) {
    words.push_back(word);
  }
  if (words.size() < 3) return FaultAtLine(number, "a vertex has fewer than three coordinates");
  // Of four numbers the last is a weight; more than four are a place and a colour.
  if (words.size() > 4) words.resize(3);
  return text.AddVertex(words, number);
}

absl::Status AddObjFace(std::string_view line, long number, ObjectText& text) {
  std::vector<std::int64_t> vertices;
  for (std::string_view word = TakeWord(line); !word.empty(); word = TakeWord(line)) {
    const std::optional<std::int64_t> index =
        WholeNumber<std::int64_t>(word.substr(0, word.find('/')));
    if (!index || *index == 0) {
      return FaultAtLine(number,
                         absl::StrCat("\"", std::string(word.substr(0, 20)), "\" names no vertex"));
    }
    // Negative numbers count back from the vertex before.
    vertices.push_back(*index > 0 ? *index - 1 : text.vertices() + *index);
  }
  return text.AddFace(vertices, number);
}

absl::Status AddStatement(std::string_view line, long number, ObjectText& text) {
  line = WithoutComment(line);
  const std::string_view word = TakeWord(line);
  if (word == "v") return AddObjVertex(line, number, text);
  if (word == "f") return AddObjFace(line, number, text);
  if (word == "o" || word == "g") text.SetComponent(Trimmed(line));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<CleanedFile> CleanObj(std::string_view bytes) {
  ObjectText text;
  TextLines lines(bytes);
  std::string joined;  // lines that go on behind a backslash
  while (const std::optional<std::string_view> line = lines.Next()) {
    if (line->ends_with('\\')) {
      joined.append(line->substr(0, line->size() - 1)) += ' ';
      continue;
    }
    joined.append(*line);
    MORTISE_RETURN_IF_ERROR(AddStatement(joined, lines.number(), text));
    joined.clear();
  }
  MORTISE_RETURN_IF_ERROR(AddStatement(joined, lines.number(), text));
  return std::move(text).Finish();
}

}  // namespace mortise::mesh
