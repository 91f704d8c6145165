// Compiles templates: parses expressions and resolves the names of parts, faces, items, materials.
#include "common/design/compiled_template.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/boundary_condition.h"
#include "common/design/parameter_values.h"
#include "common/design/template_checks.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {
namespace {

using Names = std::vector<ExpressionName>;

absl::StatusOr<PlacedExpression> Place(absl::StatusOr<Expression> parsed, std::string field) {
  if (!parsed.ok()) return InvalidField(field, std::string(parsed.status().message()));
  return PlacedExpression{*std::move(parsed), std::move(field)};
}

absl::StatusOr<PlacedExpression> CompileExpression(const std::string& text, std::string field,
                                                   const Names& parameters) {
  return Place(Expression::Parse(text, parameters), std::move(field));
}

absl::StatusOr<PlacedExpression> CompileCondition(const std::string& text, std::string field,
                                                  const Names& parameters) {
  return Place(Expression::ParseCondition(text, parameters), std::move(field));
}

// Nothing where the text is empty.
absl::Status CompilePresent(const std::string& text, const std::string& owner,
                            const Names& parameters, std::optional<PlacedExpression>& present) {
  if (text.empty()) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(present, CompileCondition(text, owner + ".present", parameters));
  return absl::OkStatus();
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

CompiledItem CompileItem(const TemplateBundle& bundle, const std::string& name) {
  const Item& item = *FindItem(bundle.items, name);
  return {name, item.material, FindMaterial(bundle.materials, item.material)->density,
          CuttingProcess(item)};
}

CompiledPeg CompilePeg(const TemplateBundle& bundle, const std::string& name) {
  const Item& peg = *FindItem(bundle.items, name);
  return {name, peg.dimensions[1].size, peg.dimensions[0].size};
}

// `compile` makes what is needed of an item.
template <typename Compiled>
absl::StatusOr<Alternatives<Compiled>> CompileItems(
    const TemplateBundle& bundle, const std::string& own, const std::vector<ConditionalItem>& items,
    const std::string& owner, const Names& parameters,
    Compiled (*compile)(const TemplateBundle&, const std::string&)) {
  Alternatives<Compiled> alternatives{compile(bundle, own)};
  for (std::size_t i = 0; i < items.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(
        PlacedExpression when,
        CompileCondition(items[i].when, absl::StrCat(owner, ".items[", i, "].when"), parameters));
    alternatives.others.emplace_back(std::move(when), compile(bundle, items[i].item));
  }
  return alternatives;
}

absl::StatusOr<CompiledRepeat> CompileRepeat(const PartRepeat& repeat, const std::string& field,
                                             const Names& parameters) {
  CompiledRepeat compiled;
  compiled.has_index = !repeat.index.empty();
  MORTISE_ASSIGN_OR_RETURN(compiled.count,
                           CompileExpression(repeat.count, field + ".count", parameters));
  const std::array<const std::string*, 3> steps = {&repeat.x, &repeat.y, &repeat.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (steps[axis]->empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(
        compiled.step[axis],
        CompileExpression(*steps[axis], absl::StrCat(field, ".", AxisName(static_cast<Axis>(axis))),
                          parameters));
  }
  return compiled;
}

absl::StatusOr<CompiledPart> CompilePart(const TemplateBundle& bundle,
                                         const PartTemplate& definition, const Names& parameters,
                                         std::string field) {
  CompiledPart part;
  part.field = std::move(field);
  part.face_names = FaceNames(definition);
  MORTISE_RETURN_IF_ERROR(CompilePresent(definition.present, part.field, parameters, part.present));
  for (std::size_t i = 0; i < definition.repeat.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(
        CompiledRepeat repeat,
        CompileRepeat(definition.repeat[i], absl::StrCat(part.field, ".repeat[", i, "]"),
                      parameters));
    part.repeat.push_back(std::move(repeat));
  }
  MORTISE_ASSIGN_OR_RETURN(part.item, CompileItems(bundle, definition.item, definition.items,
                                                   part.field, parameters, &CompileItem));
  const Names names = BodyNames(definition, parameters);
  MORTISE_RETURN_IF_ERROR(std::visit(
      [&](const auto& body) { return CompileBody(body, names, part); }, definition.body));
  return part;
}

// A part that the checks have found to exist.
CompiledReference CompileReference(const TemplateDefinition& definition, const std::string& name) {
  CopyReference reference = *ReadCopyName(name);
  const auto found =
      std::find_if(definition.parts.begin(), definition.parts.end(),
                   [&](const PartTemplate& part) { return part.name == reference.part; });
  return {static_cast<std::size_t>(found - definition.parts.begin()), std::move(reference.numbers)};
}

std::size_t IndexOfFace(const PartTemplate& part, const std::string& face) {
  const std::vector<std::string> faces = FaceNames(part);
  return static_cast<std::size_t>(std::find(faces.begin(), faces.end(), face) - faces.begin());
}

absl::StatusOr<CompiledConnection> CompileConnection(const TemplateBundle& bundle,
                                                     const Connection& connection,
                                                     const Names& parameters, std::string field) {
  CompiledConnection result;
  result.field = std::move(field);
  result.part = CompileReference(bundle.definition, connection.part);
  result.other_part = CompileReference(bundle.definition, connection.other_part);
  result.face = IndexOfFace(bundle.definition.parts[result.part.part], connection.face);
  MORTISE_RETURN_IF_ERROR(
      CompilePresent(connection.present, result.field, parameters, result.present));
  MORTISE_ASSIGN_OR_RETURN(result.peg, CompileItems(bundle, connection.item, connection.items,
                                                    result.field, parameters, &CompilePeg));
  return result;
}

std::optional<CompiledPlace> CompilePlace(const TemplateDefinition& definition,
                                          const BoundaryCondition& condition) {
  if (!ActsOnFace(condition.kind)) return std::nullopt;
  CompiledPlace place{CompileReference(definition, condition.part)};
  place.face = IndexOfFace(definition.parts[place.part.part], condition.face);
  return place;
}

}  // namespace

absl::StatusOr<bool> HoldsAt(const std::optional<PlacedExpression>& condition,
                             const Eigen::VectorXd& q) {
  if (!condition) return true;
  return HoldsAt(*condition, q);
}

absl::StatusOr<bool> HoldsAt(const PlacedExpression& condition, const Eigen::VectorXd& q) {
  absl::StatusOr<bool> holds = condition.expression.Holds(q);
  if (!holds.ok()) return InvalidField(condition.field, std::string(holds.status().message()));
  return holds;
}

bool CompiledPart::HasIndex() const {
  return std::any_of(repeat.begin(), repeat.end(),
                     [](const CompiledRepeat& direction) { return direction.has_index; });
}

std::vector<ExpressionName> NamesOf(const TemplateDefinition& definition) {
  std::vector<ExpressionName> names = ExpressionNames(definition.parameters);
  for (const Ground& ground : definition.grounds) {
    names.push_back({.name = ground.name, .ground = ground.heights});
  }
  return names;
}

std::vector<ExpressionName> BodyNames(const PartTemplate& part,
                                      std::vector<ExpressionName> parameters) {
  for (const PartRepeat& repeat : part.repeat) {
    if (!repeat.index.empty()) parameters.push_back({repeat.index, Dimension{}});
  }
  return parameters;
}

std::vector<std::string> FaceNames(const PartTemplate& part) {
  if (std::holds_alternative<Box>(part.body)) {
    return {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
  }
  std::vector<std::string> names;
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
  const Names parameters = NamesOf(definition);
  for (std::size_t i = 0; i < definition.parts.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(CompiledPart part, CompilePart(bundle, definition.parts[i], parameters,
                                                            absl::StrCat("parts[", i, "]")));
    compiled.parts.push_back(std::move(part));
  }
  for (std::size_t i = 0; i < definition.connections.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(CompiledConnection connection,
                             CompileConnection(bundle, definition.connections[i], parameters,
                                               absl::StrCat("connections[", i, "]")));
    compiled.connections.push_back(std::move(connection));
  }
  for (const BoundaryCondition& condition : definition.boundary_conditions) {
    compiled.places.push_back(CompilePlace(definition, condition));
  }
  std::vector<FieldViolation> findings;
  compiled.conditions = ConditionExpressions(
      definition.boundary_conditions, definition.reference_temperature, parameters, findings);
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return compiled;
}

}  // namespace mortise::parametric
