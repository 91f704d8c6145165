#include "common/mesh/scenes/cleaning/ply_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/object_text.h"
#include "common/mesh/scenes/cleaning/text_lines.h"

namespace mortise::mesh {
namespace {

constexpr std::size_t kMaxHeaderLength = 1 << 20;  // bytes

constexpr std::array<PlyType, 8> kTypes = {{{"char", "int8", 1},
                                            {"uchar", "uint8", 1},
                                            {"short", "int16", 2},
                                            {"ushort", "uint16", 2},
                                            {"int", "int32", 4},
                                            {"uint", "uint32", 4},
                                            {"float", "float32", 4},
                                            {"double", "float64", 8}}};

const PlyType* TypeOf(std::string_view word) {
  for (const PlyType& type : kTypes) {
    if (word == type.name || word == type.synonym) return &type;
  }
  return nullptr;
}

absl::Status ReadFormat(std::string_view line, long number, PlyHeader& header) {
  const std::string_view encoding = TakeWord(line);
  if (encoding == "ascii") {
    header.encoding = PlyEncoding::kText;
  } else if (encoding == "binary_little_endian") {
    header.encoding = PlyEncoding::kLittleEndian;
  } else if (encoding == "binary_big_endian") {
    header.encoding = PlyEncoding::kBigEndian;
  } else {
    return FaultAtLine(number, "the format is none of PLY's three");
  }
  return absl::OkStatus();
}

absl::Status ReadElement(std::string_view line, long number, PlyHeader& header) {
  PlyElement element;
  element.name = TakeWord(line);
  const auto count = WholeNumber<std::int64_t>(TakeWord(line));
  if (!count || *count < 0 || *count > INT32_MAX) {
    return FaultAtLine(number, "an element has no number that makes sense");
  }
  element.count = *count;
  header.elements.push_back(std::move(element));
  return absl::OkStatus();
}

absl::Status ReadProperty(std::string_view line, long number, PlyHeader& header) {
  if (header.elements.empty()) return FaultAtLine(number, "a property is of no element");
  PlyProperty property;
  std::string_view word = TakeWord(line);
  if (word == "list") {
    property.count_type = TypeOf(TakeWord(line));
    if (property.count_type == nullptr) return FaultAtLine(number, "a list's type is unknown");
    if (property.count_type->name == "float" || property.count_type->name == "double") {
      return FaultAtLine(number, "the length of a list is no whole number");
    }
    word = TakeWord(line);
  }
  property.type = TypeOf(word);
  if (property.type == nullptr) return FaultAtLine(number, "a property's type is unknown");
  property.name = TakeWord(line);
  header.elements.back().properties.push_back(std::move(property));
  return absl::OkStatus();
}

// Keeps what is read of the elements, and refuses what is not.
absl::Status CheckElements(PlyHeader& header) {
  std::vector<PlyElement>& elements = header.elements;
  const auto number_of = [&](std::string_view name) {
    return std::count_if(elements.begin(), elements.end(),
                         [&](const PlyElement& element) { return element.name == name; });
  };
  const auto at = [&](std::string_view name) {
    return std::find_if(elements.begin(), elements.end(),
                        [&](const PlyElement& element) { return element.name == name; });
  };
  if (number_of("tristrips") > 0) {
    return InvalidField("file", "has triangle strips, which are not read; save it with faces");
  }
  if (number_of("vertex") != 1) return InvalidField("file", "has not one list of vertices");
  if (number_of("face") == 0 || at("face")->count == 0) {
    return InvalidField("file", "has points, but no faces between them");
  }
  if (number_of("face") > 1) return InvalidField("file", "has several lists of faces");
  const auto vertex = at("vertex"), face = at("face");
  if (face < vertex) return InvalidField("file", "has its faces before its vertices");
  for (const char* axis : {"x", "y", "z"}) {
    const int property = vertex->Find(axis);
    if (property < 0 || vertex->properties[static_cast<std::size_t>(property)].IsList()) {
      return InvalidField("file", absl::StrCat("has vertices without ", axis));
    }
  }
  const int corners = face->Find(kPlyCorners, kPlyCornersSynonym);
  if (corners < 0 || !face->properties[static_cast<std::size_t>(corners)].IsList()) {
    return InvalidField("file", "has faces without vertex_indices");
  }
  elements.erase(face + 1, elements.end());
  return absl::OkStatus();
}

}  // namespace

bool PlyElement::HasLists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& property) { return property.IsList(); });
}

std::size_t PlyElement::Size() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += property.type->size;
  return size;
}

int PlyElement::Find(std::string_view wanted, std::string_view synonym) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    const std::string& found = properties[i].name;
    if (found == wanted || (!synonym.empty() && found == synonym)) return static_cast<int>(i);
  }
  return -1;
}

absl::StatusOr<PlyHeader> ReadPlyHeader(std::string_view bytes) {
  PlyHeader header;
  const std::string_view head = bytes.substr(0, kMaxHeaderLength);
  TextLines lines(head);
  while (std::optional<std::string_view> line = lines.Next()) {
    const std::string_view word = TakeWord(*line);
    if (word == "format") {
      MORTISE_RETURN_IF_ERROR(ReadFormat(*line, lines.number(), header));
    } else if (word == "element") {
      MORTISE_RETURN_IF_ERROR(ReadElement(*line, lines.number(), header));
    } else if (word == "property") {
      MORTISE_RETURN_IF_ERROR(ReadProperty(*line, lines.number(), header));
    } else if (word == "end_header") {
      // Data may begin with a byte that looks like half of a line's end, so that end is taken as
      // those of the lines before.
      const std::size_t first_end = bytes.find_first_of("\r\n");
      const bool has_two = bytes.compare(first_end, 2, "\r\n") == 0;
      const std::size_t end = static_cast<std::size_t>(word.data() - bytes.data()) + word.size();
      const std::size_t break_at = std::min(bytes.find_first_of("\r\n", end), bytes.size());
      header.length = std::min(break_at + (has_two ? 2 : 1), bytes.size());
      header.lines = lines.number();
      MORTISE_RETURN_IF_ERROR(CheckElements(header));
      return header;
    }
  }
  return InvalidField("file", "has a header without end");
}

}  // namespace mortise::mesh
