#include "tests/bench/services/retrieval/evaluation/labelled_shapes.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/files/csv_table.h"
#include "common/mesh/scenes/scene_import.h"

namespace mortise::retrieval {
namespace {

absl::StatusOr<std::size_t> ColumnOf(const parametric::CsvRow& header, const std::string& title) {
  for (std::size_t i = 0; i < header.size(); ++i)
    if (header[i].text == title) return i;
  return InvalidField("labels.csv", absl::StrCat("has no column '", title, "'"));
}

absl::StatusOr<mesh::SurfaceMesh> ReadSurface(const std::filesystem::path& path) {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path));
  const absl::StatusOr<mesh::Scene> scene = mesh::ImportScene(bytes, path.string());
  if (!scene.ok()) return InvalidField(path.string(), std::string(scene.status().message()));
  mesh::SceneComponent all = mesh::Joined(*scene);
  return mesh::SurfaceMesh{std::move(all.vertices), std::move(all.triangles)};
}

}  // namespace

absl::StatusOr<std::vector<LabelledShape>> ReadLabelledShapes(const std::filesystem::path& folder) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(folder / "labels.csv"));
  const parametric::CsvTable table = parametric::ParseCsv(text);
  if (table.rows.empty()) return InvalidField("labels.csv", "is empty");
  MORTISE_ASSIGN_OR_RETURN(const std::size_t file, ColumnOf(table.rows[0], "file"));
  MORTISE_ASSIGN_OR_RETURN(const std::size_t category, ColumnOf(table.rows[0], "category"));
  MORTISE_ASSIGN_OR_RETURN(const std::size_t source, ColumnOf(table.rows[0], "source"));
  std::vector<LabelledShape> shapes;
  for (auto row = table.rows.begin() + 1; row != table.rows.end(); ++row) {
    LabelledShape shape{.name = (*row)[file].text,
                        .category = (*row)[category].text,
                        .author = (*row)[source].text,
                        .surface = {}};
    if (absl::StartsWith(shape.author, "quat")) shape.author = "quat";
    MORTISE_ASSIGN_OR_RETURN(shape.surface, ReadSurface(folder / shape.name));
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace mortise::retrieval
