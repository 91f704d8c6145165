#include "services/retrieval/service/query_shape.h"

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/parametric_assembly.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/mesh/length_unit.h"
#include "common/mesh/scenes/scene_format.h"
#include "common/mesh/scenes/scene_reader.h"
#include "services/retrieval/families/design_surface.h"

namespace mortise::retrieval {
namespace {

// Metres for each of the file's units, where somebody says so.
absl::StatusOr<std::optional<double>> StatedUnit(const v1::QueryMesh& query) {
  if (query.length_unit().empty()) return std::nullopt;
  MORTISE_ASSIGN_OR_RETURN(const double metres, mesh::MetresOf(query.length_unit(), "length_unit"));
  return std::optional(metres);
}

// The bytes that were sent or uploaded.
absl::StatusOr<std::string> BytesOf(const v1::QueryMesh& query, const UploadedMeshes& meshes) {
  if (query.upload().empty()) {
    if (query.file().empty()) return InvalidField("file", "is missing, or empty");
    return query.file();
  }
  if (!query.file().empty()) return InvalidField("upload", "give either this or 'file'");
  return meshes.Get(query.upload());
}

absl::StatusOr<QueryShape> ReadMesh(const v1::QueryMesh& query, const UploadedMeshes& meshes) {
  const absl::StatusOr<std::optional<double>> unit = StatedUnit(query);
  const absl::StatusOr<std::string> bytes = BytesOf(query, meshes);
  const absl::Status named = mesh::CheckFileName(query.file_name());
  MORTISE_RETURN_IF_ERROR(UnderField(
      "mesh", CombineViolations(CombineViolations(bytes.status(), named), unit.status())));
  absl::StatusOr<mesh::Scene> read = mesh::ReadScene(*bytes, query.file_name());
  if (absl::IsInvalidArgument(read.status())) return UnderField("mesh", read.status());
  MORTISE_RETURN_IF_ERROR(read.status());
  const bool unit_is_known = unit->has_value() || read->unit.has_value();
  mesh::Scene scene = mesh::Settled(*std::move(read), mesh::UpAxisOf(query.up()), *unit);
  mesh::SceneComponent joined = mesh::Joined(scene);
  return QueryShape{.surface = {std::move(joined.vertices), std::move(joined.triangles)},
                    .notes = std::move(scene.notes),
                    .title = query.file_name(),
                    .unit_is_known = unit_is_known};
}

// The parts that a query names, and those below the groups of an assembly that it names.
absl::StatusOr<std::set<std::string>> PartsOf(const v1::QueryDesign& query,
                                              const templates::Template& function,
                                              const Eigen::VectorXd& q,
                                              const parametric::EvaluatedDesign& design) {
  std::set<std::string> there, parts;
  for (const parametric::EvaluatedPart& part : design.parts) there.insert(part.name);
  for (const std::string& name : query.parts()) {
    if (there.contains(name)) {
      parts.insert(name);
      continue;
    }
    MORTISE_ASSIGN_OR_RETURN(const auto assembled, function.AssemblyAt(q));
    const auto below =
        assembled ? parametric::SubTreeOf(assembled->assembly->assembly(), name)
                  : absl::StatusOr<parametric::Assembly>(absl::NotFoundError("no assembly"));
    if (!below.ok()) {
      std::vector<std::string> names(there.begin(), there.end());
      if (assembled) {
        for (const auto& group : assembled->assembly->assembly().groups) {
          names.push_back(group.name);
        }
      }
      return InvalidField("parts", absl::StrCat("the design has no part or group '", name, "'",
                                                NamesOffered(name, names)));
    }
    for (const parametric::AssemblyPart& part : below->parts) {
      if (there.contains(part.name)) parts.insert(part.name);
    }
  }
  return parts;
}

absl::StatusOr<QueryShape> ReadDesign(const v1::QueryDesign& query, TemplateSource& templates,
                                      const rpc::Origin& origin) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const SearchedTemplate> compiled,
                           templates.Get(query.template_(), query.template_revision(), origin));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd q, parametric::CompleteParameters(
                                                        compiled->design_template->parameters(),
                                                        parametric::FromProto(query.parameters())));
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design,
                           compiled->design_template->Evaluate(q));
  QueryShape shape{.surface = DesignSurface(design), .notes = {}, .title = compiled->title};
  if (query.parts().empty()) return shape;
  MORTISE_ASSIGN_OR_RETURN(const std::set<std::string> parts,
                           PartsOf(query, *compiled->design_template, q, design));
  MORTISE_ASSIGN_OR_RETURN(shape.surface, DesignSurface(design, parts));
  return shape;
}

}  // namespace

absl::StatusOr<QueryShape> ReadQuery(const v1::SearchShapesRequest& request,
                                     const Retrieval& retrieval, const rpc::Origin& origin) {
  switch (request.query_case()) {
    case v1::SearchShapesRequest::kMesh:
      return ReadMesh(request.mesh(), retrieval.meshes);
    case v1::SearchShapesRequest::kDesign: {
      absl::StatusOr<QueryShape> shape = ReadDesign(request.design(), retrieval.templates, origin);
      if (absl::IsInvalidArgument(shape.status())) return UnderField("design", shape.status());
      return shape;
    }
    case v1::SearchShapesRequest::QUERY_NOT_SET:
      break;
  }
  return InvalidField("query", "a mesh or a design is missing");
}

namespace methods {

absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadMeshResponse>>> UploadMesh(
    const Retrieval& retrieval, const rpc::Call&) {
  return retrieval.meshes.Receive();
}

}  // namespace methods
}  // namespace mortise::retrieval
