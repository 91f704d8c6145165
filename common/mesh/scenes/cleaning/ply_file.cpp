// Stanford PLY: vertices and faces, as text or binary.
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
#include "common/mesh/scenes/cleaning/ply_header.h"
#include "common/mesh/scenes/cleaning/polygon_count.h"
#include "common/mesh/scenes/cleaning/text_lines.h"

namespace mortise::mesh {
namespace {

absl::Status Ended(const PlyElement& element, std::int64_t found) {
  return InvalidField("file", absl::StrCat("declares ", element.count, " of the element ",
                                           element.name.substr(0, 20), ", but ends after ", found));
}

// ---- Text ---------------------------------------------------------------------------------------

// The words of one property: those of a list without its length. Nothing if the line ends before.
std::optional<std::vector<std::string_view>> TakeProperty(std::string_view& line,
                                                          const PlyProperty& property) {
  std::int64_t count = 1;
  if (property.IsList()) {
    const auto length = WholeNumber<std::int64_t>(TakeWord(line));
    if (!length || *length < 0) return std::nullopt;
    count = *length;
  }
  std::vector<std::string_view> words;
  for (std::int64_t i = 0; i < count; ++i) {
    words.push_back(TakeWord(line));
    if (words.back().empty()) return std::nullopt;
  }
  return words;
}

absl::Status AddElement(std::string_view line, long number, const PlyElement& element,
                        ObjectText& text) {
  std::vector<std::vector<std::string_view>> values;
  for (const PlyProperty& property : element.properties) {
    auto words = TakeProperty(line, property);
    if (!words) return FaultAtLine(number, "a line ends before all its values");
    values.push_back(*std::move(words));
  }
  const auto value = [&](int property) { return values[static_cast<std::size_t>(property)]; };
  if (element.name == "vertex") {
    return text.AddVertex(
        {value(element.Find("x"))[0], value(element.Find("y"))[0], value(element.Find("z"))[0]},
        number);
  }
  std::vector<std::int64_t> corners;
  for (const std::string_view word : value(element.Find(kPlyCorners, kPlyCornersSynonym))) {
    const auto index = WholeNumber<std::int64_t>(word);
    if (!index) return FaultAtLine(number, "a corner of a face is no whole number");
    corners.push_back(*index);
  }
  return text.AddFace(corners, number);
}

absl::StatusOr<CleanedFile> CleanText(std::string_view bytes, const PlyHeader& header) {
  ObjectText text;
  TextLines lines(bytes.substr(header.length));
  for (const PlyElement& element : header.elements) {
    for (std::int64_t i = 0; i < element.count;) {
      const std::optional<std::string_view> line = lines.Next();
      if (!line) return Ended(element, i);
      if (Trimmed(*line).empty()) continue;
      ++i;
      if (element.name != "vertex" && element.name != "face") continue;
      MORTISE_RETURN_IF_ERROR(AddElement(*line, header.lines + lines.number(), element, text));
    }
  }
  return std::move(text).Finish();
}

// ---- Binary -------------------------------------------------------------------------------------

// Walks over the data, and finds whether all that is declared is there.
class PlyWalk {
 public:
  PlyWalk(std::string_view bytes, bool is_big_endian)
      : rest_(bytes), is_big_endian_(is_big_endian) {}

  absl::Status Pass(const PlyElement& element) {
    if (element.properties.empty()) return absl::OkStatus();
    if (!element.HasLists()) {
      const auto room = static_cast<std::int64_t>(rest_.size() / element.Size());
      if (room < element.count) return Ended(element, room);
      rest_.remove_prefix(static_cast<std::size_t>(element.count) * element.Size());
      return absl::OkStatus();
    }
    const int corners = element.name == "face" ? element.Find(kPlyCorners, kPlyCornersSynonym) : -1;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        std::uint64_t count = 1;
        if (!PassProperty(element.properties[p], count)) return Ended(element, i);
        if (static_cast<int>(p) == corners) MORTISE_RETURN_IF_ERROR(polygons_.Add(count, ""));
      }
    }
    return absl::OkStatus();
  }

  std::int64_t triangles() const { return polygons_.triangles(); }
  std::size_t left() const { return rest_.size(); }

 private:
  // `count` becomes the length of a list. False if the data end before.
  bool PassProperty(const PlyProperty& property, std::uint64_t& count) {
    if (property.IsList()) {
      const std::size_t size = property.count_type->size;
      if (rest_.size() < size) return false;
      count = 0;
      for (std::size_t i = 0; i < size; ++i) {
        const auto byte = static_cast<unsigned char>(rest_[is_big_endian_ ? i : size - 1 - i]);
        count = count << 8 | byte;
      }
      rest_.remove_prefix(size);
    }
    if (count > rest_.size() / property.type->size) return false;
    rest_.remove_prefix(count * property.type->size);
    return true;
  }

  std::string_view rest_;
  const bool is_big_endian_;
  PolygonCount polygons_;
};

// The header as libassimp understands it. What is not wanted of it gets names of an element and of
// a property that it passes over; elements that it does not know it does not pass over.
std::string HeaderText(const PlyHeader& header) {
  std::string text =
      absl::StrCat("ply\nformat binary_",
                   header.encoding == PlyEncoding::kBigEndian ? "big" : "little", "_endian 1.0\n");
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    absl::StrAppend(&text, "element ", is_vertex || is_face ? element.name : "edge", " ",
                    element.count, "\n");
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const auto is = [&](const char* name, const char* synonym = "") {
        return element.Find(name, synonym) == static_cast<int>(p);
      };
      std::string name = "material_index";
      if (is_vertex && (is("x") || is("y") || is("z"))) name = property.name;
      if (is_face && is("vertex_indices", "vertex_index")) name = "vertex_indices";
      text += "property ";
      if (property.IsList()) {
        absl::StrAppend(&text, "list ", std::string(property.count_type->name), " ");
      }
      absl::StrAppend(&text, std::string(property.type->name), " ", name, "\n");
    }
  }
  // libassimp takes one line's end off the data, be it of them or not.
  return text + "end_header\n\n";
}

absl::StatusOr<CleanedFile> CleanBinary(std::string_view bytes, const PlyHeader& header) {
  const std::string_view data = bytes.substr(header.length);
  PlyWalk walk(data, header.encoding == PlyEncoding::kBigEndian);
  for (const PlyElement& element : header.elements) {
    MORTISE_RETURN_IF_ERROR(walk.Pass(element));
  }
  if (walk.triangles() == 0) return InvalidField("file", "has no faces");
  CleanedFile cleaned;
  cleaned.extension = "ply";
  cleaned.bytes = HeaderText(header);
  cleaned.bytes.append(data.substr(0, data.size() - walk.left()));
  return cleaned;
}

}  // namespace

absl::StatusOr<CleanedFile> CleanPly(std::string_view bytes) {
  MORTISE_ASSIGN_OR_RETURN(const PlyHeader header, ReadPlyHeader(bytes));
  return header.encoding == PlyEncoding::kText ? CleanText(bytes, header)
                                               : CleanBinary(bytes, header);
}

}  // namespace mortise::mesh
