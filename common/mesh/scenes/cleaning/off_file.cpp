// Object File Format: a header word, the numbers of vertices, faces and edges, then a line for each
// vertex and each face. What follows coordinates and indices (normals, colours) is passed over.
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

// The next line that is not empty but for a comment.
std::optional<std::string_view> NextFilled(TextLines& lines) {
  while (const std::optional<std::string_view> line = lines.Next()) {
    const std::string_view filled = Trimmed(WithoutComment(*line));
    if (!filled.empty()) return filled;
  }
  return std::nullopt;
}

struct OffHeader {
  std::size_t coordinates = 3;  // of a vertex
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
};

absl::StatusOr<OffHeader> ReadHeader(TextLines& lines) {
  OffHeader header;
  std::optional<std::string_view> line = NextFilled(lines);
  if (!line) return InvalidField("file", "has no header");
  const std::size_t word = line->find("OFF");
  if (word == std::string_view::npos) return FaultAtLine(lines.number(), "the word OFF is missing");
  const std::string_view kind = line->substr(0, word);
  if (kind.find('n') != std::string_view::npos) {
    return FaultAtLine(lines.number(), "surfaces in other than three dimensions are not read");
  }
  if (kind.ends_with('4')) header.coordinates = 4;
  // The numbers follow in the next line, or behind the word, with or without a space.
  std::optional<std::string_view> counts = Trimmed(line->substr(word + 3));
  if (counts->starts_with("BINARY")) {
    return FaultAtLine(lines.number(), "binary OFF is not read; save the file as text");
  }
  if (counts->empty()) counts = NextFilled(lines);
  if (!counts) return InvalidField("file", "ends before the numbers of vertices and faces");
  const auto vertices = WholeNumber<std::int64_t>(TakeWord(*counts));
  const auto faces = WholeNumber<std::int64_t>(TakeWord(*counts));
  if (!vertices || !faces || *vertices < 0 || *faces < 0) {
    return FaultAtLine(lines.number(), "the numbers of vertices and faces are missing");
  }
  header.vertices = *vertices;
  header.faces = *faces;
  return header;
}

absl::Status Ended(std::int64_t declared, const char* what, std::int64_t found) {
  return InvalidField("file",
                      absl::StrCat("declares ", declared, " ", what, ", but ends after ", found));
}

absl::Status AddOffVertex(std::string_view line, std::size_t coordinates, long number,
                          ObjectText& text) {
  std::vector<std::string_view> words;
  while (words.size() < coordinates) {
    words.push_back(TakeWord(line));
    if (words.back().empty()) return FaultAtLine(number, "a vertex has too few coordinates");
  }
  return text.AddVertex(words, number);
}

absl::Status AddOffFace(std::string_view line, long number, ObjectText& text) {
  const auto corners = WholeNumber<std::int64_t>(TakeWord(line));
  if (!corners || *corners < 0) return FaultAtLine(number, "a face has no number of corners");
  std::vector<std::int64_t> vertices;
  for (std::int64_t i = 0; i < *corners; ++i) {
    const auto index = WholeNumber<std::int64_t>(TakeWord(line));
    if (!index) {
      return FaultAtLine(number,
                         absl::StrCat("a face of ", *corners, " corners names ", i, " vertices"));
    }
    vertices.push_back(*index);
  }
  return text.AddFace(vertices, number);
}

}  // namespace

absl::StatusOr<CleanedFile> CleanOff(std::string_view bytes) {
  TextLines lines(bytes);
  MORTISE_ASSIGN_OR_RETURN(const OffHeader header, ReadHeader(lines));
  ObjectText text;
  while (text.vertices() < header.vertices) {
    const std::optional<std::string_view> line = NextFilled(lines);
    if (!line) return Ended(header.vertices, "vertices", text.vertices());
    MORTISE_RETURN_IF_ERROR(AddOffVertex(*line, header.coordinates, lines.number(), text));
  }
  while (text.faces() < header.faces) {
    const std::optional<std::string_view> line = NextFilled(lines);
    if (!line) return Ended(header.faces, "faces", text.faces());
    MORTISE_RETURN_IF_ERROR(AddOffFace(*line, lines.number(), text));
  }
  return std::move(text).Finish();
}

}  // namespace mortise::mesh
