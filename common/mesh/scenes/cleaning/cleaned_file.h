// A mesh file made ready for libassimp.
//
// libassimp 5.2 reads undamaged files of common programs well. Over others it leaves vertices or
// faces out, moves indices that are out of range, takes memory for what a header declares, cuts
// names, or joins groups. So each format is first checked and written anew, with no more in it than
// a surface needs and in the way libassimp reads rightly:
//
//   OBJ, OFF, text STL   become an OBJ of vertices, faces and objects (triangulated by libassimp)
//   PLY                  gets a header of its own, with the properties that count
//   binary STL           gets an empty header and the length it declares
//   glTF, GLB            become a GLB of the nodes, meshes and buffers of one scene
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::mesh {

struct CleanedFile {
  std::string bytes;
  std::string extension;           // by which libassimp chooses a reader
  std::vector<std::string> names;  // an object called "c7" has the eighth of these names
  std::vector<std::string> notes;  // whole sentences for people
};

// Each refuses a damaged file by INVALID_ARGUMENT, "file", with the line or element at
// fault, and more than kMaxSceneTriangles by RESOURCE_EXHAUSTED.
absl::StatusOr<CleanedFile> CleanObj(std::string_view bytes);
absl::StatusOr<CleanedFile> CleanOff(std::string_view bytes);
absl::StatusOr<CleanedFile> CleanPly(std::string_view bytes);
absl::StatusOr<CleanedFile> CleanStl(std::string_view bytes);
absl::StatusOr<CleanedFile> CleanGlb(std::string_view bytes);
absl::StatusOr<CleanedFile> CleanGltf(std::string_view bytes);

}  // namespace mortise::mesh
