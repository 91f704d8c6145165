#include "common/templates/assembly_template.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/assembly/memory_use.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/design/condition_expressions.h"
#include "common/design/field_checks.h"
#include "common/design/parameter_values.h"
#include "common/design/part_shapes.h"
#include "common/design/template_validation.h"
#include "common/expressions/identifier.h"

namespace mortise::templates {
namespace {

using parametric::BoundaryCondition;
using parametric::ConditionExpressions;
using parametric::Measure;
using parametric::MeasureRange;
using parametric::Parameter;
using parametric::ParametricAssembly;

constexpr double kSlack = 1e-9;           // m, beyond the range that the assembly allows
constexpr double kIndependent = 1e-6;     // of a size's own change: what others leave open of it
constexpr std::size_t kMaxHandles = 100;  // demands that an adjustment may have
constexpr std::size_t kMaxConditions = 500;

// "top shelf 1", x: "top_shelf_1_x".
std::string ParameterName(const Measure& measure) {
  std::string name = absl::StrCat(measure.element, "_", parametric::AxisName(measure.axis));
  for (char& letter : name) {
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  }
  if (std::isdigit(static_cast<unsigned char>(name.front())) != 0) name.insert(0, "_");
  return name;
}

// The parameters that the handles are, with what is wrong with them.
std::vector<Parameter> ParametersOf(const ParametricAssembly& assembly,
                                    const std::vector<AssemblyHandle>& handles,
                                    std::vector<FieldViolation>& findings) {
  std::vector<Parameter> parameters;
  std::set<std::string> names;
  std::set<std::tuple<std::string, parametric::Axis, parametric::MeasureKind>> measures;
  if (handles.empty() || handles.size() > kMaxHandles) {
    findings.push_back({"assembly.handles", absl::StrCat("must be 1 to ", kMaxHandles)});
  }
  for (std::size_t i = 0; i < std::min(handles.size(), kMaxHandles); ++i) {
    const AssemblyHandle& handle = handles[i];
    const std::string field = absl::StrCat("assembly.handles[", i, "]");
    if (!parametric::IsIdentifier(handle.parameter) || parametric::IsReserved(handle.parameter)) {
      findings.push_back({absl::StrCat(field, ".parameter"),
                          "must be an identifier, and no word of the expression language"});
    } else if (!names.insert(handle.parameter).second) {
      findings.push_back({absl::StrCat(field, ".parameter"), "is given twice"});
    }
    parametric::CheckTitle(absl::StrCat(field, ".title"), handle.title, findings);
    if (!measures.insert({handle.measure.element, handle.measure.axis, handle.measure.kind})
             .second) {
      findings.push_back({absl::StrCat(field, ".measure"), "is given twice"});
      continue;
    }
    const absl::StatusOr<MeasureRange> range = assembly.RangeOf(handle.measure);
    if (!range.ok()) {
      findings.push_back({absl::StrCat(field, ".measure"), std::string(range.status().message())});
      continue;
    }
    if (range->maximum - range->minimum <= kSlack) {
      findings.push_back({absl::StrCat(field, ".measure"), "cannot change"});
      continue;
    }
    const bool own = handle.minimum != 0 || handle.maximum != 0;
    const double minimum = own ? handle.minimum : range->minimum;
    const double maximum = own ? handle.maximum : range->maximum;
    if (!(minimum < maximum && minimum <= range->drawn + kSlack &&
          maximum >= range->drawn - kSlack)) {
      findings.push_back(
          {absl::StrCat(field, ".minimum"),
           absl::StrCat("to maximum must be a range with the drawn length ", range->drawn, " m")});
    } else if (minimum < range->minimum - kSlack || maximum > range->maximum + kSlack) {
      findings.push_back({absl::StrCat(field, ".minimum"),
                          absl::StrCat("to maximum must lie within what the assembly allows, ",
                                       range->minimum, " to ", range->maximum, " m")});
    }
    if (!(handle.step >= 0 && handle.step <= maximum - minimum)) {
      findings.push_back({absl::StrCat(field, ".step"), "must be at least 0 and within the range"});
    }
    parameters.push_back({.name = handle.parameter,
                          .title = handle.title,
                          .description = "",
                          .unit = "m",
                          .minimum = minimum,
                          .maximum = maximum,
                          .default_value = std::clamp(range->drawn, minimum, maximum),
                          .step = handle.step});
  }
  return parameters;
}

// What the drawn assembly lacks of the conditions' parts and faces.
void CheckPlaces(const parametric::EvaluatedDesign& drawn,
                 const std::vector<BoundaryCondition>& conditions,
                 std::vector<FieldViolation>& findings) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const BoundaryCondition& condition = conditions[i];
    const std::string field = absl::StrCat("boundary_conditions[", i, "]");
    if (condition.name.empty() || !names.insert(condition.name).second) {
      findings.push_back({field + ".name", "must be there, and distinct"});
    }
    if (!parametric::ActsOnFace(condition.kind)) continue;
    const int part = parametric::FindPart(drawn, condition.part);
    if (part < 0) {
      findings.push_back(
          {field + ".part", absl::StrCat("there is no part '", condition.part, "'",
                                         NamesOffered(condition.part, drawn.parts,
                                                      &parametric::EvaluatedPart::name))});
      continue;
    }
    const parametric::EvaluatedPart& of = drawn.parts[static_cast<std::size_t>(part)];
    if (of.connecting) {
      findings.push_back({field + ".part", "only connects others, which analyses leave out"});
    } else if (std::find(of.face_names.begin(), of.face_names.end(), condition.face) ==
               of.face_names.end()) {
      findings.push_back(
          {field + ".face", absl::StrCat("there is no face '", condition.face, "'",
                                         NamesOffered(condition.face, of.face_names))});
    }
  }
}

// The conditions, if there are not too many of them to be looked at.
ConditionExpressions ConditionsOf(const parametric::EvaluatedDesign& drawn,
                                  const AssemblyTemplate& definition,
                                  const std::vector<parametric::ExpressionName>& parameters,
                                  std::vector<FieldViolation>& findings) {
  if (definition.boundary_conditions.size() > kMaxConditions) {
    findings.push_back({"boundary_conditions", absl::StrCat("are more than ", kMaxConditions)});
    return {};
  }
  CheckPlaces(drawn, definition.boundary_conditions, findings);
  return {definition.boundary_conditions, definition.reference_temperature, parameters, findings};
}

class HandledAssembly final : public Template {
 public:
  HandledAssembly(TemplateHead head, std::shared_ptr<const ParametricAssembly> assembly,
                  std::vector<AssemblyHandle> handles, ConditionExpressions conditions)
      : Template(std::move(head)),
        assembly_(std::move(assembly)),
        handles_(std::move(handles)),
        conditions_(std::move(conditions)) {}

  absl::StatusOr<ParameterLimits> LimitsAmongParameters() const override {
    std::vector<Measure> measures;
    for (const AssemblyHandle& handle : handles_) measures.push_back(handle.measure);
    MORTISE_ASSIGN_OR_RETURN(parametric::PolyhedronShadow values, assembly_->ValuesOf(measures));
    return ParameterLimits{std::move(values.inequalities), std::move(values.bounds)};
  }

  std::size_t MemoryUse() const override {
    return Template::MemoryUse() + parametric::MemoryUse(*assembly_);
  }

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Adjustment adjusted, AdjustedTo(q));
    parametric::EvaluatedDesign design =
        parametric::DesignAt(*assembly_, adjusted.q, head().items, head().materials);
    MORTISE_RETURN_IF_ERROR(AddConditions(q, design));
    return design;
  }

  absl::StatusOr<parametric::Structure> CountsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Adjustment adjusted, AdjustedTo(q));
    parametric::EvaluatedDesign conditioned;  // whose conditions may not be computed at q
    conditioned.structure = parametric::StructureAt(*assembly_, adjusted.q);
    MORTISE_RETURN_IF_ERROR(AddConditions(q, conditioned));
    return *std::move(conditioned.structure);
  }

  absl::StatusOr<std::vector<cad::Solid>> SolidsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Adjustment adjusted, AdjustedTo(q));
    const parametric::EvaluatedDesign design =
        parametric::DesignAt(*assembly_, adjusted.q, head().items, head().materials);
    const std::vector<parametric::PlacedPart> placed = assembly_->PartsAt(adjusted.q);
    std::vector<cad::Solid> solids;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      MORTISE_ASSIGN_OR_RETURN(cad::Solid solid, SolidOf(placed[i], design.parts[i]));
      solids.push_back(std::move(solid));
    }
    return solids;
  }

  absl::StatusOr<std::optional<AssemblyDesign>> AssemblyDesignAt(
      const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(parametric::Adjustment adjusted, AdjustedTo(q));
    return AssemblyDesign{assembly_, std::move(adjusted.q)};
  }

 private:
  absl::StatusOr<parametric::Adjustment> AdjustedTo(const Eigen::VectorXd& q) const {
    std::vector<parametric::MeasureDemand> demands;
    for (std::size_t i = 0; i < handles_.size(); ++i) {
      demands.push_back({handles_[i].measure, q(static_cast<Eigen::Index>(i))});
    }
    return assembly_->Meet(demands);
  }

  absl::Status AddConditions(const Eigen::VectorXd& q, parametric::EvaluatedDesign& design) const {
    for (std::size_t i = 0; i < conditions_.size(); ++i) {
      MORTISE_ASSIGN_OR_RETURN(const bool is_present, conditions_.IsPresent(i, q));
      if (!is_present) {
        design.structure->absent_conditions.push_back(conditions_.NameOf(i));
        continue;
      }
      MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedBoundaryCondition condition,
                               conditions_.At(i, q));
      design.boundary_conditions.push_back(std::move(condition));
    }
    MORTISE_ASSIGN_OR_RETURN(design.reference_temperature, conditions_.ReferenceTemperature(q));
    return absl::OkStatus();
  }

  absl::StatusOr<cad::Solid> SolidOf(const parametric::PlacedPart& placed,
                                     const parametric::EvaluatedPart& part) const {
    const auto& shape = assembly_->ShapeOf(placed);
    if (shape == nullptr) return cad::Solid::FromPart(parametric::PartShapeOf(part));
    const absl::StatusOr<cad::Solid> solid = cad::SolidOfShape(*shape, placed.stretch, part.name);
    if (!solid.ok()) return UnderField(absl::StrCat("part '", part.name, "'"), solid.status());
    return cad::MovedSolid(*solid, placed.box.minimum);
  }

  const std::shared_ptr<const ParametricAssembly> assembly_;
  const std::vector<AssemblyHandle> handles_;
  const ConditionExpressions conditions_;
};

}  // namespace

absl::StatusOr<std::vector<AssemblyHandle>> IndependentSizes(const ParametricAssembly& assembly,
                                                             std::size_t limit) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<MeasureRange> sizes, assembly.AdjustableSizes());
  std::stable_sort(sizes.begin(), sizes.end(),
                   [](const MeasureRange& a, const MeasureRange& b) { return a.drawn > b.drawn; });
  const Eigen::MatrixXd& basis = assembly.feasible_set().basis();
  std::vector<Eigen::VectorXd> chosen;  // orthonormal: the changes that those before make
  std::vector<AssemblyHandle> handles;
  std::set<std::string> names;
  for (const MeasureRange& range : sizes) {
    if (handles.size() == limit) break;
    const auto& elements = assembly.elements();
    const auto found = std::find_if(elements.begin(), elements.end(), [&](const auto& element) {
      return element.name == range.measure.element;
    });
    const int element = static_cast<int>(found - elements.begin());
    const Eigen::VectorXd change =
        basis.row(parametric::SizeVariable(element, range.measure.axis)).transpose();
    Eigen::VectorXd open = change;
    // Twice: once is not exactly orthogonal.
    for (int pass = 0; pass < 2; ++pass) {
      for (const Eigen::VectorXd& other : chosen) open -= other.dot(open) * other;
    }
    if (open.norm() <= kIndependent * change.norm()) continue;
    std::string name = ParameterName(range.measure);
    if (!parametric::IsIdentifier(name) || parametric::IsReserved(name)) continue;
    // "side-1" and "side 1" are one in the letters of identifiers.
    for (int number = 2; !names.insert(name).second; ++number) {
      name = absl::StrCat(ParameterName(range.measure), "_", number);
    }
    chosen.push_back(open.normalized());
    handles.push_back({.parameter = name,
                       .measure = range.measure,
                       .title = absl::StrCat(range.measure.element, " along ",
                                             parametric::AxisName(range.measure.axis))});
  }
  return handles;
}

absl::StatusOr<std::shared_ptr<const Template>> MakeAssemblyTemplate(
    TemplateHead head, std::shared_ptr<const ParametricAssembly> assembly,
    AssemblyTemplate definition) {
  std::vector<FieldViolation> findings;
  head.parameters = ParametersOf(*assembly, definition.handles, findings);
  const std::vector<parametric::ExpressionName> names =
      parametric::ExpressionNames(head.parameters);
  const parametric::EvaluatedDesign drawn =
      parametric::DesignAt(*assembly, assembly->drawn(), head.items, head.materials);
  ConditionExpressions conditions = ConditionsOf(drawn, definition, names, findings);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  return std::make_shared<const HandledAssembly>(
      std::move(head), std::move(assembly), std::move(definition.handles), std::move(conditions));
}

}  // namespace mortise::templates
