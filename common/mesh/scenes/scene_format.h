// Which format a mesh file has, told by what is in it.
#pragma once

#include <optional>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::mesh {

enum class SceneFormat {
  kObj,   // Wavefront OBJ
  kOff,   // Object File Format: OFF, COFF, NOFF, STOFF, 4OFF, as text
  kPly,   // Stanford PLY, as text or binary in either byte order
  kGltf,  // glTF 2.0 as JSON, whose buffers are within it
  kGlb,   // glTF 2.0, binary
  kStl,   // STL, as text or binary
};

// "OBJ", "OFF", "PLY", "glTF", "GLB" or "STL".
std::string_view NameOf(SceneFormat format);

// Fails with INVALID_ARGUMENT, "file_name": a text that no file is called by, as it has more than
// 255 bytes or control characters. None at all is right.
absl::Status CheckFileName(std::string_view file_name);

// Returns the format that a file is called after, by its extension in either case (".obj"), or by
// the extension alone ("obj"); nothing for others.
std::optional<SceneFormat> FormatOfName(std::string_view file_name);

// Returns the format of a file by its content alone. INVALID_ARGUMENT, "file": it is empty, or it
// is none of the six; then the message says what it is instead where that is plain (STEP, FBX,
// COLLADA, a ZIP archive, a picture …). It looks at the beginning only, so a file with a format may
// still be damaged. `named`, the format that the file is called after, only decides for binary
// files that look like nothing else: they are STL if they are called so, and its reader finds their
// fault.
absl::StatusOr<SceneFormat> DetectSceneFormat(std::string_view bytes,
                                              std::optional<SceneFormat> named = std::nullopt);

}  // namespace mortise::mesh
