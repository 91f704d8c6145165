#include "services/retrieval/service/query_shape.h"

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/mesh/scenes/scene_reader.h"
#include "services/retrieval/families/design_surface.h"

namespace mortise::retrieval {
namespace {

// Metres for each unit; nothing for an unknown one.
std::optional<double> LengthOf(const std::string& unit) {
  static const std::map<std::string, double> units = {{"m", 1},     {"cm", 0.01},   {"mm", 0.001},
                                                      {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
  const auto found = units.find(unit);
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

mesh::UpAxis UpAxisOf(v1::Axis axis) {
  switch (axis) {
    case v1::X:
      return mesh::UpAxis::kX;
    case v1::Y:
      return mesh::UpAxis::kY;
    case v1::Z:
      return mesh::UpAxis::kZ;
    default:
      return mesh::UpAxis::kUnknown;
  }
}

absl::Status CheckMesh(const v1::QueryMesh& query) {
  absl::Status status;
  if (query.file().empty()) status = InvalidField("file", "is missing");
  if (!query.length_unit().empty() && !LengthOf(query.length_unit())) {
    status = Together(status, InvalidField("length_unit", "must be m, cm, mm, um, in or ft"));
  }
  return status;
}

// In metres where the unit is known, z upwards.
mesh::Scene Settled(mesh::Scene scene, const v1::QueryMesh& query) {
  mesh::UpAxis up = UpAxisOf(query.up());
  if (up == mesh::UpAxis::kUnknown) up = scene.up;
  if (up != mesh::UpAxis::kUnknown) scene = mesh::TurnedUpright(std::move(scene), up);
  std::optional<double> unit = LengthOf(query.length_unit());
  if (!unit) unit = scene.unit;
  if (!unit) {
    if (const std::optional<mesh::UnitGuess> guess = mesh::GuessUnit(scene)) {
      unit = guess->unit;
      scene.notes.push_back(guess->remark);
    } else {
      scene.notes.push_back("The unit is not known: give length_unit for sizes in metres.");
    }
  }
  return unit ? mesh::Scaled(std::move(scene), *unit) : scene;
}

absl::StatusOr<QueryShape> ReadMesh(const v1::QueryMesh& query) {
  MORTISE_RETURN_IF_ERROR(UnderField("mesh", CheckMesh(query)));
  absl::StatusOr<mesh::Scene> read = mesh::ReadScene(query.file(), query.file_name());
  if (absl::IsInvalidArgument(read.status())) return UnderField("mesh", read.status());
  MORTISE_RETURN_IF_ERROR(read.status());
  mesh::Scene scene = Settled(*std::move(read), query);
  mesh::SceneComponent joined = mesh::Joined(scene);
  return QueryShape{.surface = {std::move(joined.vertices), std::move(joined.triangles)},
                    .notes = std::move(scene.notes),
                    .title = query.file_name()};
}

absl::StatusOr<QueryShape> ReadDesign(const v1::QueryDesign& query, TemplateSource& templates,
                                      const rpc::Origin& origin) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const CompiledTemplate> compiled,
                           templates.Get(query.template_(), query.template_revision(), origin));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd q,
                           parametric::Complete(compiled->function->parameters(),
                                                parametric::FromProto(query.parameters())));
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design,
                           compiled->function->Evaluate(q));
  QueryShape shape{.surface = DesignSurface(design), .notes = {}, .title = compiled->title};
  if (query.parts().empty()) return shape;
  const absl::StatusOr<mesh::SurfaceMesh> some =
      DesignSurface(design, {query.parts().begin(), query.parts().end()});
  if (!some.ok()) {
    return InvalidField(
        "parts", absl::StrCat("the design has no part '", DetailOf(some.status()).field, "'"));
  }
  shape.surface = *some;
  return shape;
}

}  // namespace

absl::StatusOr<QueryShape> ReadQuery(const v1::SearchShapesRequest& request,
                                     TemplateSource& templates, const rpc::Origin& origin) {
  switch (request.query_case()) {
    case v1::SearchShapesRequest::kMesh:
      return ReadMesh(request.mesh());
    case v1::SearchShapesRequest::kDesign: {
      absl::StatusOr<QueryShape> shape = ReadDesign(request.design(), templates, origin);
      if (absl::IsInvalidArgument(shape.status())) return UnderField("design", shape.status());
      return shape;
    }
    case v1::SearchShapesRequest::QUERY_NOT_SET:
      break;
  }
  return InvalidField("query", "a mesh or a design is missing");
}

}  // namespace mortise::retrieval
