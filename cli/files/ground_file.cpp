#include "cli/files/ground_file.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/files/ground_grid.h"
#include "cli/files/ground_mesh.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/messages/proto_text.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

void Scale(const GroundUnits& units, v1::HeightGrid& grid) {
  grid.set_x(grid.x() * units.unit - units.origin.x());
  grid.set_y(grid.y() * units.unit - units.origin.y());
  grid.set_x_spacing(grid.x_spacing() * units.unit);
  grid.set_y_spacing(grid.y_spacing() * units.unit);
  for (double& height : *grid.mutable_heights()) height *= units.unit;
}

void Scale(const GroundUnits& units, v1::HeightTriangles& triangles) {
  for (int i = 0; i < triangles.vertices_size(); ++i) {
    const double off = i % 3 == 0 ? units.origin.x() : i % 3 == 1 ? units.origin.y() : 0;
    triangles.set_vertices(i, triangles.vertices(i) * units.unit - off);
  }
}

absl::StatusOr<v1::HeightField> ReadMessage(const std::string& text, const std::string& origin,
                                            const GroundUnits& units) {
  if (units.unit != 1) return InvalidField("--unit", absl::StrCat(origin, " is in metres"));
  v1::HeightField field;
  MORTISE_RETURN_IF_ERROR(parametric::ParseProtoText(text, origin, field));
  if (field.has_grid()) Scale(units, *field.mutable_grid());
  if (field.has_triangles()) Scale(units, *field.mutable_triangles());
  return field;
}

}  // namespace

absl::StatusOr<v1::HeightField> ReadGround(const std::filesystem::path& file,
                                           const GroundUnits& units) {
  using ParseGrid = absl::StatusOr<v1::HeightGrid> (*)(std::string_view, const std::string&);
  using ParseTriangles =
      absl::StatusOr<v1::HeightTriangles> (*)(std::string_view, const std::string&);
  const std::string extension = LowerCaseExtension(file);
  const ParseGrid grid = extension == ".csv"   ? &ParseGroundPoints
                         : extension == ".asc" ? &ParseEsriGrid
                                               : nullptr;
  const ParseTriangles triangles = extension == ".obj"   ? &ParseObjGround
                                   : extension == ".stl" ? &ParseStlGround
                                                         : nullptr;
  if (grid == nullptr && triangles == nullptr && extension != ".textproto") {
    return InvalidField(file.string(),
                        "is no .csv with points, .asc, .obj, .stl or .textproto by its name");
  }
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxBytes));
  if (extension == ".textproto") return ReadMessage(text, file.string(), units);
  v1::HeightField field;
  if (grid != nullptr) {
    MORTISE_ASSIGN_OR_RETURN(*field.mutable_grid(), grid(text, file.string()));
    Scale(units, *field.mutable_grid());
  } else {
    MORTISE_ASSIGN_OR_RETURN(*field.mutable_triangles(), triangles(text, file.string()));
    Scale(units, *field.mutable_triangles());
  }
  return field;
}

}  // namespace mortise::cli
