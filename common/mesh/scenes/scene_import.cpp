#include "common/mesh/scenes/scene_import.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/text_encoding.h"
#include "common/mesh/scenes/assimp_reader.h"
#include "common/mesh/scenes/cleaning/cleaned_file.h"
#include "common/mesh/scenes/cleaning/object_text.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/mesh/scenes/scene_format.h"

namespace mortise::mesh {
namespace {

absl::StatusOr<CleanedFile> Clean(std::string_view bytes, SceneFormat format) {
  switch (format) {
    case SceneFormat::kObj:
      return CleanObj(SkipByteOrderMark(bytes));
    case SceneFormat::kOff:
      return CleanOff(SkipByteOrderMark(bytes));
    case SceneFormat::kPly:
      return CleanPly(bytes);
    case SceneFormat::kStl:
      return CleanStl(bytes);
    case SceneFormat::kGlb:
      return CleanGlb(bytes);
    case SceneFormat::kGltf:
      return CleanGltf(SkipByteOrderMark(bytes));
  }
  return InvalidField("file", "is of no format that is read");
}

// How many bytes at the beginning of a text are one character of UTF-8; 0 for none.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = static_cast<unsigned char>(text[0]);
  if (byte < 0x80) return 1;
  const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : 2;
  if (byte < 0xC2 || byte > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return 0;
  }
  const auto second = static_cast<unsigned char>(text[1]);
  if ((byte == 0xE0 && second < 0xA0) || (byte == 0xED && second >= 0xA0) ||
      (byte == 0xF0 && second < 0x90) || (byte == 0xF4 && second >= 0x90)) {
    return 0;
  }
  return length;
}

// A name as UTF-8 of a length that can be shown; what is none of UTF-8 becomes the replacement
// character.
std::string ReadableName(std::string_view name) {
  std::string readable;
  while (!name.empty() && readable.size() < kMaxSceneNameBytes) {
    const std::size_t length = CharacterLength(name);
    if (length > 1 || (length == 1 && static_cast<unsigned char>(name[0]) >= ' ')) {
      readable.append(name.substr(0, length));
    } else {
      readable.append(length == 0 ? "\xEF\xBF\xBD" : " ");
    }
    name.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return readable;
}

void MergeTooMany(Scene& scene) {
  if (scene.components.size() <= kMaxSceneComponents) return;
  scene.notes.push_back(TooManyComponents(scene.components.size()));
  SceneComponent all = Joined(scene);
  scene.components.clear();
  scene.components.push_back(std::move(all));
}

}  // namespace

absl::StatusOr<Scene> ImportScene(std::string_view bytes, std::string_view file_name) {
  if (bytes.size() > kMaxSceneBytes) return TooLarge("file", "64 MiB");
  const std::optional<SceneFormat> named = FormatOfName(file_name);
  MORTISE_ASSIGN_OR_RETURN(const SceneFormat format, DetectSceneFormat(bytes, named));
  MORTISE_ASSIGN_OR_RETURN(const CleanedFile cleaned, Clean(bytes, format));
  MORTISE_ASSIGN_OR_RETURN(Scene scene, ReadByAssimp(cleaned));
  if (scene.components.empty()) {
    return InvalidField("file",
                        "has no triangle that has an area, to the seven digits that coordinates "
                        "are read with: a thing far from the origin is to be moved to it");
  }
  if (format == SceneFormat::kGlb || format == SceneFormat::kGltf) {
    scene.unit = 1;
    scene.up = UpAxis::kY;
  }
  std::vector<std::string> notes = cleaned.notes;
  if (named && named != format) {
    notes.insert(notes.begin(),
                 absl::StrCat("The file is called ", std::string(NameOf(*named)), ", but is ",
                              std::string(NameOf(format)), ", and was read as such."));
  }
  scene.notes.insert(scene.notes.begin(), notes.begin(), notes.end());
  MergeTooMany(scene);
  for (SceneComponent& component : scene.components) {
    component.name = ReadableName(component.name);
  }
  return scene;
}

}  // namespace mortise::mesh
