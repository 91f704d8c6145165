// Writes the OBJ text that libassimp gets in the place of text formats.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/scenes/cleaning/cleaned_file.h"
#include "common/mesh/scenes/cleaning/polygon_count.h"

namespace mortise::mesh {

class ObjectText {
 public:
  // Adds a vertex by the words of its coordinates: three, or four of which the last divides the
  // others. INVALID_ARGUMENT, "file", naming the line, for words that are no finite numbers and for
  // a divisor of 0.
  absl::Status AddVertex(const std::vector<std::string_view>& words, long line);

  // Adds a face by its vertices, counted from 0; a face of fewer than three is left out and
  // counted. An index may be of a vertex that comes later. RESOURCE_EXHAUSTED as PolygonCount.
  absl::Status AddFace(const std::vector<std::int64_t>& vertices, long line);

  // Faces from here on are of this component. The same name again is the same component.
  void SetComponent(std::string_view name);

  std::int64_t vertices() const { return vertices_; }
  std::int64_t faces() const { return polygons_.faces(); }

  // Components past kMaxSceneComponents become one, with a note. INVALID_ARGUMENT, "file": an index
  // of no vertex, with its line; no face at all.
  absl::StatusOr<CleanedFile> Finish() &&;

 private:
  std::string vertex_text_;
  std::vector<std::string> face_texts_;  // one a component
  std::vector<std::string> names_;
  std::map<std::string, std::size_t, std::less<>> component_of_;
  std::size_t component_ = 0;
  std::int64_t vertices_ = 0;
  PolygonCount polygons_;
  std::int64_t incomplete_ = 0;  // faces of fewer than three vertices
  std::int64_t highest_ = -1;    // index of a vertex
  long highest_line_ = 0;
};

// Says that all components became one, as there are more than kMaxSceneComponents.
std::string TooManyComponents(std::size_t count);

// Returns INVALID_ARGUMENT, "file": "line 12: what".
absl::Status FaultAtLine(long line, std::string_view what);

}  // namespace mortise::mesh
