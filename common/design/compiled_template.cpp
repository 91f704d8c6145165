// Compiles templates: parses expressions and resolves the names of parts, faces, items, materials.
#include "common/design/compiled_template.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/template_checks.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {
namespace {

using Names = std::vector<std::string>;

absl::StatusOr<PlacedExpression> CompileExpression(const std::string& text, std::string field,
                                                   const Names& parameters) {
  absl::StatusOr<Expression> parsed = Expression::Parse(text, parameters);
  if (!parsed.ok()) return InvalidField(field, std::string(parsed.status().message()));
  return PlacedExpression{*std::move(parsed), std::move(field)};
}

absl::Status CompileExtent(const Extent& extent, const std::string& field, const Names& parameters,
                           PlacedExpression& from, PlacedExpression& to) {
  MORTISE_ASSIGN_OR_RETURN(
      from, CompileExpression(extent.from, absl::StrCat(field, ".from"), parameters));
  MORTISE_ASSIGN_OR_RETURN(to,
                           CompileExpression(extent.to, absl::StrCat(field, ".to"), parameters));
  return absl::OkStatus();
}

absl::Status CompileBody(const Box& box, const Names& parameters, CompiledPart& part) {
  part.axis = Axis::kZ;
  part.u.resize(2);
  part.v.resize(2);
  part.u_of_corner = {0, 1, 1, 0};
  part.v_of_corner = {0, 0, 1, 1};
  MORTISE_RETURN_IF_ERROR(
      CompileExtent(box.x, absl::StrCat(part.field, ".box.x"), parameters, part.u[0], part.u[1]));
  MORTISE_RETURN_IF_ERROR(
      CompileExtent(box.y, absl::StrCat(part.field, ".box.y"), parameters, part.v[0], part.v[1]));
  return CompileExtent(box.z, absl::StrCat(part.field, ".box.z"), parameters, part.from, part.to);
}

absl::Status CompileBody(const Prism& prism, const Names& parameters, CompiledPart& part) {
  part.axis = prism.axis;
  for (std::size_t i = 0; i < prism.outline.size(); ++i) {
    const std::string point = absl::StrCat(part.field, ".prism.outline[", i, "]");
    MORTISE_ASSIGN_OR_RETURN(
        PlacedExpression u,
        CompileExpression(prism.outline[i].u, absl::StrCat(point, ".u"), parameters));
    MORTISE_ASSIGN_OR_RETURN(
        PlacedExpression v,
        CompileExpression(prism.outline[i].v, absl::StrCat(point, ".v"), parameters));
    part.u.push_back(std::move(u));
    part.v.push_back(std::move(v));
    part.u_of_corner.push_back(static_cast<int>(i));
    part.v_of_corner.push_back(static_cast<int>(i));
  }
  return CompileExtent(prism.extent, absl::StrCat(part.field, ".prism.extent"), parameters,
                       part.from, part.to);
}

absl::StatusOr<CompiledPart> CompilePart(const TemplateBundle& bundle,
                                         const PartTemplate& definition, std::string field) {
  CompiledPart part;
  part.field = std::move(field);
  part.face_names = FaceNames(definition);
  const Item& item = *FindItem(bundle.items, definition.item);
  part.material = item.material;
  part.density = FindMaterial(bundle.materials, item.material)->density;
  part.process = CuttingProcess(item);
  const Names parameters = ParameterNames(bundle.definition);
  MORTISE_RETURN_IF_ERROR(std::visit(
      [&](const auto& body) { return CompileBody(body, parameters, part); }, definition.body));
  return part;
}

// The index of a part that the checks have found to exist.
std::size_t IndexOfPart(const TemplateDefinition& definition, const std::string& name) {
  return static_cast<std::size_t>(
      std::find_if(definition.parts.begin(), definition.parts.end(),
                   [&name](const PartTemplate& part) { return part.name == name; }) -
      definition.parts.begin());
}

CompiledConnection CompileConnection(const TemplateBundle& bundle, const Connection& connection,
                                     std::string field) {
  CompiledConnection result;
  result.field = std::move(field);
  result.part = IndexOfPart(bundle.definition, connection.part);
  result.other_part = IndexOfPart(bundle.definition, connection.other_part);
  const Names faces = FaceNames(bundle.definition.parts[result.part]);
  result.face = static_cast<std::size_t>(std::find(faces.begin(), faces.end(), connection.face) -
                                         faces.begin());
  const Item& peg = *FindItem(bundle.items, connection.item);
  result.length = peg.dimensions[0].size;
  result.diameter = peg.dimensions[1].size;
  return result;
}

}  // namespace

std::vector<std::string> ParameterNames(const TemplateDefinition& definition) {
  Names names;
  for (const Parameter& parameter : definition.parameters) names.push_back(parameter.name);
  return names;
}

std::vector<std::string> FaceNames(const PartTemplate& part) {
  if (std::holds_alternative<Box>(part.body)) {
    return {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
  }
  Names names;
  for (std::size_t i = 0; i < std::get<Prism>(part.body).outline.size(); ++i) {
    names.push_back(absl::StrCat("side", i));
  }
  names.push_back("base");
  names.push_back("cap");
  return names;
}

Process CuttingProcess(const Item& item) {
  for (const ItemDimension& dimension : item.dimensions) {
    if (dimension.process == Process::kChopSaw || dimension.process == Process::kJigsaw) {
      return dimension.process;
    }
  }
  return Process::kNone;
}

absl::StatusOr<CompiledTemplate> CompileTemplate(const TemplateBundle& bundle) {
  MORTISE_RETURN_IF_ERROR(ToStatus(CheckTemplate(bundle)));
  CompiledTemplate compiled;
  compiled.bundle = bundle;
  const TemplateDefinition& definition = bundle.definition;
  for (std::size_t i = 0; i < definition.parts.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(CompiledPart part, CompilePart(bundle, definition.parts[i],
                                                            absl::StrCat("parts[", i, "]")));
    compiled.parts.push_back(std::move(part));
  }
  for (std::size_t i = 0; i < definition.connections.size(); ++i) {
    compiled.connections.push_back(
        CompileConnection(bundle, definition.connections[i], absl::StrCat("connections[", i, "]")));
  }
  std::vector<FieldViolation> findings;
  compiled.conditions =
      ConditionExpressions(definition.boundary_conditions, definition.reference_temperature,
                           ParameterNames(definition), findings);
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return compiled;
}

}  // namespace mortise::parametric
