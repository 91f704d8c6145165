// Reads the meshes that people have: OBJ, OFF, PLY, STL, and glTF as GLB or JSON.
//
// The surface is taken as it is: open, crossing itself, flipped, doubled, flat, of a single
// triangle. A file is read in a child process with limits of memory and time
// (common/base/isolated_child.h), as libassimp, which reads it, may crash over a damaged one.
//
// What the formats give:
//   components   objects and groups of OBJ (faces under one name are one component, wherever they
//                stand; materials make none), solids of text STL, nodes of glTF that have a mesh,
//                with all transforms applied; one without a name for others. Connected pieces:
//                mesh_components.h
//   unit         metres of glTF by its definition; the others have none (GuessUnit, scene.h)
//   up axis      +y of glTF by its definition; the others have none
//   coordinates  in single precision, as libassimp reads them: 1e-7 of their size
//   polygons     become triangles, whether convex or not
//   left out     triangles without area (of a height below 1e-12 of their longest side), faces of
//                fewer than three corners, points, lines, free-form surfaces, materials, pictures,
//                colours, bones (the surface is at rest), animations, vertices that no triangle
//                uses
// Corners at the same place in a component are one vertex; triangles keep their order.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/mesh/scenes/scene.h"

namespace mortise::mesh {

// The argument that makes a program a child: its main() returns RunSceneChild() if it is the first.
inline constexpr char kSceneChildArgument[] = "--read-mesh-for-parent";

// Reads a file from standard input and writes what ReadScene makes of it to standard output.
int RunSceneChild();

struct SceneReaderOptions {
  std::string program = "/proc/self/exe";           // whose main() knows kSceneChildArgument
  std::chrono::seconds time_limit = kMaxSceneTime;  // by the clock
};

// Returns the scene in a file. Its format is told by its content (scene_format.h); `file_name`, or
// its extension alone, or nothing, only serves a note where the two differ.
//
// Errors, all of the field "file":
//   INVALID_ARGUMENT     the file is empty; of another format (the message says of which where that
//                        is plain); damaged, with the line, element or number at fault: indices out
//                        of range, coordinates that are not finite, data that end before what is
//                        declared, nodes within themselves; without triangles that have an area; a
//                        glTF whose buffers are in other files, of version 1, or compressed; over
//                        it libassimp crashes
//   RESOURCE_EXHAUSTED   the file has more than 64 MiB or 2,000,000 triangles (counted before they
//                        are built; nodes that repeat a mesh count each time), a face of more than
//                        10,000 corners, or so many faces of very many that they take too long to
//                        divide (polygon_count.h; told by the face's number); or needs more than
//                        1 GiB of addresses beside the program's, 60 s of processor time or
//                        `time_limit`
//   INTERNAL             no child can be started
// Further limits: 256 nodes within nodes; with more than 10,000 components all become one, and a
// note says so; names are cut after some 200 bytes. Any number of calls may run at once.
absl::StatusOr<Scene> ReadScene(std::string_view bytes, std::string_view file_name,
                                const SceneReaderOptions& options = {});

}  // namespace mortise::mesh
