#include "common/templates/assembly_template.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/solid_shape.h"
#include "common/parametric/assembly_design.h"
#include "common/parametric/expression.h"
#include "common/parametric/field_checks.h"
#include "common/parametric/identifier.h"
#include "common/parametric/memory_use.h"
#include "common/parametric/part_shapes.h"
#include "common/parametric/template_validation.h"

namespace mortise::templates {
namespace {

using parametric::BoundaryCondition;
using parametric::BoundaryConditionKind;
using parametric::Finding;
using parametric::Measure;
using parametric::MeasureRange;
using parametric::Parameter;
using parametric::ParametricAssembly;

constexpr double kSlack = 1e-9;           // m, beyond the range that the assembly allows
constexpr double kIndependent = 1e-6;     // of a size's own change: what others leave open of it
constexpr std::size_t kMaxHandles = 100;  // demands that an adjustment may have
constexpr std::size_t kMaxConditions = 500;

struct CompiledCondition {
  BoundaryCondition condition;
  std::vector<parametric::Expression> components;
};

// "top shelf 1", x: "top_shelf_1_x".
std::string ParameterName(const Measure& measure) {
  std::string name = absl::StrCat(measure.element, "_", parametric::AxisName(measure.axis));
  for (char& letter : name) {
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  }
  if (std::isdigit(static_cast<unsigned char>(name.front())) != 0) name.insert(0, "_");
  return name;
}

std::size_t ComponentsOf(BoundaryConditionKind kind) {
  switch (kind) {
    case BoundaryConditionKind::kForce:
      return 3;
    case BoundaryConditionKind::kPressure:
      return 1;
    default:
      return 0;
  }
}

// The parameters that the handles are, with what is wrong with them.
std::vector<Parameter> ParametersOf(const ParametricAssembly& assembly,
                                    const std::vector<AssemblyHandle>& handles,
                                    std::vector<Finding>& findings) {
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

std::vector<CompiledCondition> ConditionsOf(const parametric::EvaluatedDesign& drawn,
                                            const std::vector<BoundaryCondition>& conditions,
                                            const std::vector<std::string>& parameters,
                                            std::vector<Finding>& findings) {
  std::vector<CompiledCondition> compiled;
  std::set<std::string> names;
  if (conditions.size() > kMaxConditions) {
    findings.push_back({"boundary_conditions", absl::StrCat("are more than ", kMaxConditions)});
    return compiled;
  }
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const BoundaryCondition& condition = conditions[i];
    const std::string field = absl::StrCat("boundary_conditions[", i, "]");
    if (condition.name.empty() || !names.insert(condition.name).second) {
      findings.push_back({absl::StrCat(field, ".name"), "must be there, and distinct"});
    }
    const int part = parametric::FindPart(drawn, condition.part);
    if (part < 0) {
      findings.push_back(
          {absl::StrCat(field, ".part"), absl::StrCat("there is no part '", condition.part, "'")});
    } else if (drawn.parts[static_cast<std::size_t>(part)].connecting) {
      findings.push_back(
          {absl::StrCat(field, ".part"), "only connects others, which analyses leave out"});
    } else {
      const auto& faces = drawn.parts[static_cast<std::size_t>(part)].face_names;
      if (std::find(faces.begin(), faces.end(), condition.face) == faces.end()) {
        findings.push_back({absl::StrCat(field, ".face"),
                            absl::StrCat("there is no face '", condition.face, "'")});
      }
    }
    CompiledCondition entry{condition, {}};
    if (condition.components.size() != ComponentsOf(condition.kind)) {
      findings.push_back({absl::StrCat(field, ".components"),
                          absl::StrCat("must be ", ComponentsOf(condition.kind))});
    }
    for (std::size_t k = 0; k < condition.components.size(); ++k) {
      auto expression = parametric::Expression::Parse(condition.components[k], parameters);
      if (expression.ok()) {
        entry.components.push_back(*std::move(expression));
      } else {
        findings.push_back({absl::StrCat(field, ".components[", k, "]"),
                            std::string(expression.status().message())});
      }
    }
    compiled.push_back(std::move(entry));
  }
  return compiled;
}

class HandledAssembly final : public Template {
 public:
  HandledAssembly(TemplateHead head, std::shared_ptr<const ParametricAssembly> assembly,
                  std::vector<AssemblyHandle> handles, std::vector<CompiledCondition> conditions)
      : Template(std::move(head)),
        assembly_(std::move(assembly)),
        handles_(std::move(handles)),
        conditions_(std::move(conditions)) {}

  std::size_t MemoryUse() const override {
    return Template::MemoryUse() + parametric::MemoryUse(*assembly_);
  }

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Adjustment adjusted, AdjustedTo(q));
    parametric::EvaluatedDesign design =
        parametric::DesignAt(*assembly_, adjusted.q, head().items, head().materials);
    for (std::size_t i = 0; i < conditions_.size(); ++i) {
      MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedBoundaryCondition condition, ConditionAt(i, q));
      design.boundary_conditions.push_back(std::move(condition));
    }
    return design;
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
    return assembly_->Adjust(assembly_->drawn(), demands, parametric::Insistence::kStrict);
  }

  absl::StatusOr<cad::Solid> SolidOf(const parametric::PlacedPart& placed,
                                     const parametric::EvaluatedPart& part) const {
    const auto& shape = assembly_->ShapeOf(placed);
    if (shape == nullptr) return cad::Solid::FromPart(parametric::PartShapeOf(part));
    const absl::StatusOr<cad::Solid> solid =
        cad::SolidOfShape(*shape, placed.box.size(), part.name);
    if (!solid.ok()) return UnderField(absl::StrCat("part '", part.name, "'"), solid.status());
    return cad::MovedSolid(*solid, placed.box.minimum);
  }

  absl::StatusOr<parametric::EvaluatedBoundaryCondition> ConditionAt(
      std::size_t index, const Eigen::VectorXd& q) const {
    const CompiledCondition& compiled = conditions_[index];
    std::vector<double> values;
    for (std::size_t k = 0; k < compiled.components.size(); ++k) {
      const absl::StatusOr<double> value = compiled.components[k].Value(q);
      if (!value.ok()) {
        return InvalidField(absl::StrCat("boundary_conditions[", index, "].components[", k, "]"),
                            std::string(value.status().message()));
      }
      values.push_back(*value);
    }
    const BoundaryCondition& condition = compiled.condition;
    parametric::EvaluatedBoundaryCondition evaluated{.name = condition.name,
                                                     .kind = condition.kind,
                                                     .part = condition.part,
                                                     .face = condition.face};
    if (condition.kind == BoundaryConditionKind::kForce) {
      evaluated.force = Eigen::Vector3d(values[0], values[1], values[2]);
    } else if (condition.kind == BoundaryConditionKind::kPressure) {
      evaluated.pressure = values[0];
    }
    return evaluated;
  }

  const std::shared_ptr<const ParametricAssembly> assembly_;
  const std::vector<AssemblyHandle> handles_;
  const std::vector<CompiledCondition> conditions_;
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
  std::vector<Finding> findings;
  head.parameters = ParametersOf(*assembly, definition.handles, findings);
  std::vector<std::string> names;
  for (const Parameter& parameter : head.parameters) names.push_back(parameter.name);
  const parametric::EvaluatedDesign drawn =
      parametric::DesignAt(*assembly, assembly->drawn(), head.items, head.materials);
  std::vector<CompiledCondition> conditions =
      ConditionsOf(drawn, definition.boundary_conditions, names, findings);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  return std::make_shared<const HandledAssembly>(
      std::move(head), std::move(assembly), std::move(definition.handles), std::move(conditions));
}

}  // namespace mortise::templates
