#include "tests/bench/services/retrieval/evaluation/labelled_shapes.h"

#include <utility>

#include "absl/strings/match.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/mesh/scenes/scene_import.h"
#include "tests/bench/services/retrieval/families/mesh_family.h"

namespace mortise::retrieval {
namespace {

absl::StatusOr<mesh::SurfaceMesh> ReadSurface(const std::filesystem::path& path) {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path));
  const absl::StatusOr<mesh::Scene> scene = mesh::ImportScene(bytes, path.string());
  if (!scene.ok()) return InvalidField(path.string(), std::string(scene.status().message()));
  mesh::SceneComponent all = mesh::Joined(*scene);
  return mesh::SurfaceMesh{std::move(all.vertices), std::move(all.triangles)};
}

}  // namespace

std::string AuthorOf(const std::string& source) {
  return absl::StartsWith(source, "quat") ? "quat" : source;
}

absl::StatusOr<std::vector<LabelledShape>> ReadLabelledShapes(const std::filesystem::path& folder) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<bench::LabelledMesh> meshes,
                           bench::ReadLabels(folder));
  std::vector<LabelledShape> shapes;
  for (const bench::LabelledMesh& mesh : meshes) {
    LabelledShape shape{.name = mesh.path.lexically_relative(folder).generic_string(),
                        .category = mesh.category,
                        .author = AuthorOf(mesh.source),
                        .surface = {}};
    MORTISE_ASSIGN_OR_RETURN(shape.surface, ReadSurface(mesh.path));
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace mortise::retrieval
