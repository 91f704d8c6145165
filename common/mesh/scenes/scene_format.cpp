#include "common/mesh/scenes/scene_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/text_encoding.h"
#include "common/mesh/scenes/cleaning/stl_length.h"
#include "common/mesh/scenes/cleaning/text_lines.h"

namespace mortise::mesh {
namespace {

constexpr std::size_t kMaxFileName = 255;  // bytes, as file systems have it

using std::string_view_literals::operator""sv;

struct NamedFormat {
  SceneFormat format;
  std::string_view name;
  std::string_view extension;
};
constexpr std::array<NamedFormat, 6> kFormats = {{{SceneFormat::kObj, "OBJ", "obj"},
                                                  {SceneFormat::kOff, "OFF", "off"},
                                                  {SceneFormat::kPly, "PLY", "ply"},
                                                  {SceneFormat::kGltf, "glTF", "gltf"},
                                                  {SceneFormat::kGlb, "GLB", "glb"},
                                                  {SceneFormat::kStl, "STL", "stl"}}};

// How files that are none of ours begin.
struct OtherFormat {
  std::string_view beginning;
  std::string_view name;
};
constexpr std::array<OtherFormat, 17> kOthers = {
    {{"ISO-10303-21", "a STEP file"},
     {"PK\3\4", "a ZIP archive (as 3MF files are, or packed files)"},
     {"\x1f\x8b", "packed by gzip"},
     {"7z\xbc\xaf", "a 7-Zip archive"},
     {"Rar!", "a RAR archive"},
     {"Kaydara FBX", "an FBX file"},
     {"; FBX", "an FBX file"},
     {"BLENDER", "a file of Blender"},
     {"MM\0*"sv, "a TIFF picture"},
     {"\x89PNG", "a PNG picture"},
     {"\xff\xd8\xff", "a JPEG picture"},
     {"%PDF", "a PDF document"},
     {"<?xml", "an XML document (as COLLADA, AMF and X3D are)"},
     {"<COLLADA", "a COLLADA document"},
     {"<!DOCTYPE html", "a web page"},
     {"<html", "a web page"},
     {"DXF", "a DXF drawing"}}};

// The header word of OFF, with what may stand before it.
bool IsOff(std::string_view word) {
  if (word.starts_with("ST")) word.remove_prefix(2);
  for (const char letter : {'C', 'N', '4', 'n'}) {
    if (word.starts_with(letter)) word.remove_prefix(1);
  }
  return word.starts_with("OFF");
}

bool IsPly(std::string_view bytes) {
  return bytes.size() > 3 && (bytes.starts_with("ply") || bytes.starts_with("PLY")) &&
         (bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ');
}

// Whether a line is a vertex or a face of an OBJ file.
bool IsObjLine(std::string_view line) {
  const std::string_view word = TakeWord(line);
  if (word == "v") return DecimalNumber(TakeWord(line)) && DecimalNumber(TakeWord(line));
  if (word != "f") return false;
  const std::string_view corner = TakeWord(line);
  return WholeNumber<std::int64_t>(corner.substr(0, corner.find('/'))).has_value();
}

std::optional<SceneFormat> FormatOfText(std::string_view text) {
  TextLines lines(text);
  bool is_first = true;
  while (const std::optional<std::string_view> line = lines.Next()) {
    std::string_view filled = Trimmed(WithoutComment(*line));
    if (filled.empty()) continue;
    if (is_first && IsOff(filled)) return SceneFormat::kOff;
    if (is_first && filled.starts_with('{')) return SceneFormat::kGltf;
    is_first = false;
    if (IsObjLine(filled)) return SceneFormat::kObj;
  }
  return std::nullopt;
}

absl::Status IsNone(std::string_view what) {
  return InvalidField("file",
                      absl::StrCat(absl::string_view(what.data(), what.size()),
                                   "; meshes are read from OBJ, OFF, PLY, STL, GLB and glTF"));
}

}  // namespace

std::string_view NameOf(SceneFormat format) {
  for (const NamedFormat& known : kFormats) {
    if (known.format == format) return known.name;
  }
  return "";
}

absl::Status CheckFileName(std::string_view file_name) {
  const bool is_text = std::none_of(file_name.begin(), file_name.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == 127;
  });
  if (is_text && file_name.size() <= kMaxFileName) return absl::OkStatus();
  return InvalidField("file_name",
                      absl::StrCat("must be text of at most ", kMaxFileName, " bytes"));
}

std::optional<SceneFormat> FormatOfName(std::string_view file_name) {
  const std::size_t dot = file_name.rfind('.');
  std::string extension(dot == std::string_view::npos ? file_name : file_name.substr(dot + 1));
  for (char& letter : extension) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  for (const NamedFormat& known : kFormats) {
    if (known.extension == extension) return known.format;
  }
  return std::nullopt;
}

absl::StatusOr<SceneFormat> DetectSceneFormat(std::string_view bytes,
                                              std::optional<SceneFormat> named) {
  if (bytes.empty()) return InvalidField("file", "is empty");
  if (bytes.starts_with("glTF")) return SceneFormat::kGlb;
  if (IsPly(bytes)) return SceneFormat::kPly;
  if (IsTextStl(bytes)) return SceneFormat::kStl;
  const std::uint64_t facets = DeclaredStlFacets(bytes);
  if (facets > 0 && kStlHeader + kStlFacet * facets <= bytes.size()) return SceneFormat::kStl;
  if (const std::string fault = EncodingFault(bytes); !fault.empty()) {
    return InvalidField("file", fault);
  }
  const std::string_view text = SkipByteOrderMark(bytes);
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  for (const OtherFormat& other : kOthers) {
    if (text.substr(begin).starts_with(other.beginning)) {
      return IsNone(absl::StrCat("is ", std::string(other.name)));
    }
  }
  if (text.substr(0, 4096).find('\0') != std::string_view::npos) {
    if (named == SceneFormat::kStl && bytes.size() >= kStlHeader) return SceneFormat::kStl;
    return IsNone("is no mesh file of a format that is read");
  }
  if (const auto format = FormatOfText(text)) return *format;
  if (begin == text.size()) return InvalidField("file", "is empty but for spaces");
  return IsNone("has neither vertices nor faces of a format that is read");
}

}  // namespace mortise::mesh
