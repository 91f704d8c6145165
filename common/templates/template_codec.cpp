#include "common/templates/template_codec.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/design/field_checks.h"
#include "common/design/metric_registry.h"
#include "common/design/parameter_values.h"
#include "common/design/template_validation.h"
#include "common/files/height_field_codec.h"
#include "common/files/metric_codec.h"
#include "common/files/template_codec.h"
#include "common/files/template_reader.h"
#include "common/templates/assembly_template.h"
#include "common/templates/cage/codec/cage_template_codec.h"
#include "common/templates/cage_template.h"
#include "common/templates/feature_template.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/parts_template.h"

namespace mortise::templates {
namespace {

using Compiled = absl::StatusOr<std::shared_ptr<const Template>>;

constexpr std::size_t kFilledHandles = 12;
constexpr std::size_t kMaxTriedEnds = 6;  // parameters; twice as many designs
constexpr int kTriedCorners = 12;
constexpr std::size_t kMaxTriedChoices = 8;  // values of a parameter

// How assemblies are parametrised, and who waits for that.
struct Parametrizing {
  const Parametrize& parametrize;
  const std::function<bool()>& is_given_up;
};

absl::StatusOr<TemplateHead> HeadOf(const v1::TemplateBundle& bundle) {
  const v1::Template& message = bundle.template_();
  TemplateHead head{.name = message.name(),
                    .revision = message.revision(),
                    .digest = message.digest(),
                    .title = message.title(),
                    .parameters = {},
                    .items = {},
                    .materials = {}};
  for (const v1::Item& item : bundle.items()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item converted, parametric::FromProto(item));
    head.items.push_back(std::move(converted));
  }
  for (const v1::Material& material : bundle.materials()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Material converted, parametric::FromProto(material));
    head.materials.push_back(std::move(converted));
  }
  return head;
}

absl::StatusOr<Parametrization> AssemblyOf(const v1::TemplateBundle& bundle,
                                           const Parametrizing& parametrizing) {
  v1::AssemblyBundle exposed;
  *exposed.mutable_assembly() = bundle.assembly();
  *exposed.mutable_items() = bundle.items();
  *exposed.mutable_materials() = bundle.materials();
  *exposed.mutable_shapes() = bundle.shapes();
  return parametrizing.parametrize(exposed, parametrizing.is_given_up,
                                   bundle.template_().assembly().group());
}

// What is wrong with the assembly as it is drawn names a part or a joint of it. All else that is
// wrong with a sub-tree is so because it is by itself.
absl::Status UnderAssembly(const absl::Status& status, const v1::AssemblyTemplate& message) {
  const std::string field = DetailOf(status).field;
  if (field == "group") return UnderField("assembly", status);
  const bool is_by_itself = !message.group().empty() && field.empty();
  return UnderField(is_by_itself ? "assembly.group" : "assembly.assembly", status);
}

absl::StatusOr<AssemblyHandle> HandleOf(const v1::AssemblyHandle& message,
                                        const std::string& field) {
  MORTISE_ASSIGN_OR_RETURN(parametric::Measure measure,
                           parametric::FromProto(message.measure(), field + ".measure"));
  return AssemblyHandle{message.parameter(), std::move(measure), message.title(),
                        message.minimum(),   message.maximum(),  message.step()};
}

absl::StatusOr<AssemblyTemplate> DefinitionOf(const v1::Template& message) {
  AssemblyTemplate definition;
  for (int i = 0; i < message.assembly().handles_size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(
        AssemblyHandle handle,
        HandleOf(message.assembly().handles(i), absl::StrCat("assembly.handles[", i, "]")));
    definition.handles.push_back(std::move(handle));
  }
  for (int i = 0; i < message.boundary_conditions_size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(parametric::BoundaryCondition condition,
                             parametric::FromProto(message.boundary_conditions(i),
                                                   absl::StrCat("boundary_conditions[", i, "]")));
    definition.boundary_conditions.push_back(std::move(condition));
  }
  definition.reference_temperature = message.reference_temperature();
  return definition;
}

Compiled CompileCad(const v1::TemplateBundle& bundle, TemplateHead head) {
  const v1::Template& message = bundle.template_();
  absl::StatusOr<cad::CadTemplate> definition = cad::FromProto(message.cad());
  if (!definition.ok()) return UnderField("cad", definition.status());
  definition->name = message.name();
  Compiled made = MakeFeatureTemplate(std::move(head), *std::move(definition));
  if (!made.ok()) return UnderField("cad", made.status());
  return made;
}

Compiled CompileCage(const v1::TemplateBundle& bundle, TemplateHead head) {
  const v1::Template& message = bundle.template_();
  absl::StatusOr<parametric::CageTemplate> definition = parametric::FromProto(message.cage());
  if (!definition.ok()) return UnderField("cage", definition.status());
  definition->name = message.name();
  Compiled made = MakeCageTemplate(std::move(head), *std::move(definition));
  if (!made.ok()) return UnderField("cage", made.status());
  return made;
}

// Fills in the handles if there are none.
absl::Status FillHandles(const parametric::ParametricAssembly& assembly,
                         v1::AssemblyTemplate& message) {
  if (message.handles_size() > 0) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const std::vector<AssemblyHandle> handles,
                           IndependentSizes(assembly, kFilledHandles));
  for (const AssemblyHandle& handle : handles) {
    v1::AssemblyHandle& added = *message.add_handles();
    added.set_parameter(handle.parameter);
    added.set_title(handle.title);
    *added.mutable_measure() = parametric::ToProto(handle.measure);
  }
  return absl::OkStatus();
}

Compiled CompileAssembly(const v1::TemplateBundle& bundle, TemplateHead head,
                         const Parametrizing& parametrizing, v1::AssemblyTemplate* fill) {
  absl::StatusOr<Parametrization> assembly = AssemblyOf(bundle, parametrizing);
  if (!assembly.ok()) return UnderAssembly(assembly.status(), bundle.template_().assembly());
  v1::Template message = bundle.template_();
  if (fill != nullptr) {
    MORTISE_RETURN_IF_ERROR(FillHandles(**assembly, *fill));
    *message.mutable_assembly() = *fill;
  }
  MORTISE_ASSIGN_OR_RETURN(AssemblyTemplate definition, DefinitionOf(message));
  return MakeAssemblyTemplate(std::move(head), *std::move(assembly), std::move(definition));
}

Compiled CompileParts(const v1::TemplateBundle& bundle) {
  absl::StatusOr<parametric::TemplateBundle> converted = parametric::FromProto(bundle);
  MORTISE_RETURN_IF_ERROR(converted.status());
  return MakePartsTemplate(*converted);
}

// `fill` takes the handles of an assembly template that has none.
Compiled CompileWith(const v1::TemplateBundle& bundle, const Parametrizing& parametrizing,
                     v1::AssemblyTemplate* fill) {
  switch (bundle.template_().kind_case()) {
    case v1::Template::KIND_NOT_SET:
      return CompileParts(bundle);
    case v1::Template::kAssembly: {
      MORTISE_ASSIGN_OR_RETURN(TemplateHead head, HeadOf(bundle));
      return CompileAssembly(bundle, std::move(head), parametrizing, fill);
    }
    case v1::Template::kCad: {
      MORTISE_ASSIGN_OR_RETURN(TemplateHead head, HeadOf(bundle));
      return CompileCad(bundle, std::move(head));
    }
    case v1::Template::kCage: {
      MORTISE_ASSIGN_OR_RETURN(TemplateHead head, HeadOf(bundle));
      return CompileCage(bundle, std::move(head));
    }
  }
  return InvalidField("kind", "is not known");
}

// What a message of a kind says besides.
void CheckHead(const v1::Template& message, std::vector<FieldViolation>& findings) {
  if (message.parts_size() > 0) findings.push_back({"parts", "must be left out beside a kind"});
  if (message.connections_size() > 0) {
    findings.push_back({"connections", "must be left out beside a kind"});
  }
  if (!message.has_assembly() && message.boundary_conditions_size() > 0) {
    findings.push_back({"boundary_conditions", "must be those of the kind"});
  }
  if (!message.has_assembly() && !message.reference_temperature().empty()) {
    findings.push_back({"reference_temperature", "must be that of the kind"});
  }
  if (!message.has_assembly() && message.has_metric_definitions()) {
    findings.push_back({"metric_definitions", "must be those of the kind"});
  }
  for (int i = 0; i < message.height_fields_size(); ++i) {
    findings.push_back(
        {absl::StrCat("height_fields[", i, "]"),
         absl::StrCat("'", message.height_fields(i).name().substr(0, 80),
                      "' must be left out: only templates of parts stand on ground")});
  }
  const std::string& name = message.has_cad() ? message.cad().name() : message.cage().name();
  if (!name.empty() && name != message.name()) {
    findings.push_back({message.has_cad() ? "cad.name" : "cage.name",
                        absl::StrCat("must be ", message.name(), ", or left out")});
  }
}

// Sets a text of the head to that of the kind; they may not differ.
void FillText(const std::string& field, const std::string& text, std::string& head,
              std::vector<FieldViolation>& findings) {
  if (!head.empty() && head != text) {
    findings.push_back({field, "differs from that of its kind: leave it out"});
  }
  head = text;
}

// A sub-tree is called after its group as well; what is said of the whole does not describe it.
void FillFromAssembly(const v1::Assembly& assembly, v1::Template& message) {
  const std::string& group = message.assembly().group();
  if (message.title().empty()) {
    message.set_title(group.empty() ? assembly.title()
                                    : absl::StrCat(assembly.title(), ": ", group));
  }
  if (message.description().empty() && group.empty()) {
    message.set_description(assembly.description());
  }
}

void FillHead(const v1::TemplateBundle& bundle, const Template& compiled, v1::Template& message,
              std::vector<FieldViolation>& findings) {
  if (message.has_cad()) {
    FillText("title", message.cad().title(), *message.mutable_title(), findings);
    FillText("description", message.cad().description(), *message.mutable_description(), findings);
    message.mutable_cad()->set_name(message.name());
  } else if (message.has_cage()) {
    FillText("title", message.cage().title(), *message.mutable_title(), findings);
    FillText("description", message.cage().description(), *message.mutable_description(), findings);
    message.mutable_cage()->set_name(message.name());
  } else {
    FillFromAssembly(bundle.assembly(), message);
  }
  // Those of the other kinds have been checked with what they are made of.
  if (message.has_assembly()) {
    parametric::CheckTitle("title", message.title(), findings);
    parametric::CheckDescription("description", message.description(), findings);
  }
  v1::Template filled;
  for (const parametric::Parameter& parameter : compiled.parameters()) {
    *filled.add_parameters() = parametric::ToProto(parameter);
  }
  v1::Template given;
  *given.mutable_parameters() = message.parameters();
  if (message.parameters_size() > 0 &&
      !google::protobuf::util::MessageDifferencer::Equals(given, filled)) {
    findings.push_back({"parameters", "differ from those of its kind: leave them out"});
  }
  *message.mutable_parameters() = filled.parameters();
}

// Writes what choices leave out.
void FillChoices(google::protobuf::RepeatedPtrField<v1::Parameter>& parameters) {
  for (v1::Parameter& parameter : parameters) {
    if (parameter.choices_size() > 0) {
      parameter = parametric::ToProto(parametric::FromProto(parameter));
    }
  }
}

// What the design at q cannot be, said with where that is. False if it cannot.
bool Try(const Template& compiled, const Eigen::VectorXd& q, const std::string& kind,
         const std::string& where, std::vector<FieldViolation>& findings) {
  const absl::Status status = compiled.Evaluate(q).status();
  if (status.ok()) return true;
  // A field is named only by what is at fault in the template; the kernel's failures name none.
  const std::vector<FieldViolation> violations = AllViolationsOf(status);
  for (const FieldViolation& violation : violations) {
    // Those of an assembly template are beside its kind.
    const bool beside = kind == "assembly" && (violation.field.starts_with("boundary_conditions") ||
                                               violation.field == "reference_temperature");
    findings.push_back({absl::StrCat(beside ? "" : kind + ".", violation.field),
                        absl::StrCat(where, ": ", violation.message)});
  }
  if (violations.empty()) {
    findings.push_back({kind, absl::StrCat(where, ": ", status.message())});
  }
  return false;
}

// The ends of a number; all values of a choice, if they are not too many.
std::vector<double> TriedValues(const parametric::Parameter& parameter) {
  if (!parameter.IsChoice()) return {parameter.minimum, parameter.maximum};
  std::vector<double> values;
  const std::size_t count = std::min(parameter.choices.size(), kMaxTriedChoices);
  for (std::size_t value = 0; value < count; ++value) values.push_back(static_cast<double>(value));
  return values;
}

// The ends of every parameter, one at a time.
void TryEnds(const Template& compiled, const std::string& kind,
             const std::function<bool()>& is_given_up, std::vector<FieldViolation>& findings) {
  const Eigen::VectorXd defaults = parametric::Defaults(compiled.parameters());
  for (Eigen::Index i = 0; i < defaults.size(); ++i) {
    const parametric::Parameter& parameter = compiled.parameters()[static_cast<std::size_t>(i)];
    for (const double value : TriedValues(parameter)) {
      Eigen::VectorXd q = defaults;
      q(i) = value;
      if (is_given_up()) return;
      const std::string& choice = parametric::ChoiceAt(parameter, value);
      Try(compiled, q, kind,
          choice.empty() ? absl::StrCat("at ", parameter.name, " = ", value)
                         : absl::StrCat("at ", parameter.name, " = ", choice),
          findings);
    }
  }
}

// Corners of the parameter box, always the same.
void TryCorners(const Template& compiled, const std::string& kind,
                const std::function<bool()>& is_given_up, std::vector<FieldViolation>& findings) {
  std::mt19937 bits(1);
  for (int corner = 0; corner < kTriedCorners; ++corner) {
    Eigen::VectorXd q(static_cast<Eigen::Index>(compiled.parameters().size()));
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const parametric::Parameter& parameter = compiled.parameters()[static_cast<std::size_t>(i)];
      q(i) = parameter.IsChoice() ? static_cast<double>(bits() % parameter.choices.size())
             : (bits() & 1U) != 0 ? parameter.maximum
                                  : parameter.minimum;
    }
    if (is_given_up()) return;
    Try(compiled, q, kind, "at " + parametric::ToText(compiled.parameters(), q), findings);
  }
}

// A solid takes up to a second, and somebody waits: a dozen or so are tried. The ends of an
// assembly's handles are exact, and a cage has been tried all over already.
void TryAll(const Template& compiled, const std::string& kind,
            const std::function<bool()>& is_given_up, std::vector<FieldViolation>& findings) {
  const std::vector<parametric::Parameter>& parameters = compiled.parameters();
  const Eigen::VectorXd defaults =
      parametric::RoundToSteps(parameters, parametric::Defaults(parameters));
  if (!Try(compiled, defaults, kind, "at the defaults", findings) || kind != "cad") return;
  if (parameters.size() <= kMaxTriedEnds) {
    TryEnds(compiled, kind, is_given_up, findings);
  } else {
    TryCorners(compiled, kind, is_given_up, findings);
  }
}

absl::Status CompleteParts(v1::TemplateBundle& bundle) {
  FillChoices(*bundle.mutable_template_()->mutable_parameters());
  MORTISE_ASSIGN_OR_RETURN(const TemplateHead used, HeadOf(bundle));
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(
      parametric::ValidateTemplateMessage(bundle.template_(), used.items, used.materials)));
  for (v1::HeightField& heights : *bundle.mutable_template_()->mutable_height_fields()) {
    heights.set_digest(parametric::HeightsDigest(heights));
  }
  return absl::OkStatus();
}

absl::Status CompleteKind(v1::TemplateBundle& bundle, Trial trial,
                          const Parametrizing& parametrizing) {
  const std::function<bool()>& is_given_up = parametrizing.is_given_up;
  v1::Template& message = *bundle.mutable_template_();
  if (message.has_cad()) FillChoices(*message.mutable_cad()->mutable_parameters());
  if (message.has_cage()) FillChoices(*message.mutable_cage()->mutable_parameters());
  FillChoices(*message.mutable_parameters());
  std::vector<FieldViolation> findings;
  CheckHead(message, findings);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  v1::AssemblyTemplate handles = message.assembly();
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const Template> compiled,
                           CompileWith(bundle, parametrizing, &handles));
  if (message.has_assembly()) *message.mutable_assembly() = std::move(handles);
  FillHead(bundle, *compiled, message, findings);
  const std::string kind = message.has_cad() ? "cad" : message.has_assembly() ? "assembly" : "cage";
  if (trial == Trial::kThorough || message.has_assembly()) {
    TryAll(*compiled, kind, is_given_up, findings);
  }
  if (is_given_up()) return absl::CancelledError("nobody waits for the template any more");
  return parametric::ToStatus(findings);
}

// Those of the kind where those of the template are not filled in.
const google::protobuf::RepeatedPtrField<v1::Parameter>& ParametersOf(const v1::Template& message) {
  if (message.has_cad()) return message.cad().parameters();
  if (message.has_cage()) return message.cage().parameters();
  return message.parameters();
}

// Whether own metrics can be checked: what follows from faults of parameters is not told, and
// those of an assembly are known only when it has none.
bool KnowsParameters(const v1::Template& message, const absl::Status& completed) {
  if (completed.ok()) return true;
  if (!absl::IsInvalidArgument(completed) || message.has_assembly()) return false;
  for (const FieldViolation& violation : AllViolationsOf(completed)) {
    if (absl::StrContains(violation.field, "parameters")) return false;
  }
  return true;
}

absl::Status CheckCustomMetrics(const v1::Template& message) {
  std::vector<parametric::NamedUnit> parameters;
  for (const v1::Parameter& parameter : ParametersOf(message)) {
    parameters.push_back({parameter.name(),
                          parameter.unit(),
                          {parameter.choices().begin(), parameter.choices().end()}});
  }
  std::vector<FieldViolation> findings =
      parametric::ValidateMetricDefinitions(parametric::MetricDefinitionsOf(message), parameters,
                                            simulator::UnitsOf(simulator::OfferedMetrics()));
  const std::string kind = message.has_cad() ? "cad." : message.has_cage() ? "cage." : "";
  for (FieldViolation& finding : findings) finding.field = kind + finding.field;
  return parametric::ToStatus(findings);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Template>> Compile(const v1::TemplateBundle& bundle,
                                                        const Parametrize& parametrize) {
  return CompileWith(bundle, {parametrize, [] { return false; }}, nullptr);
}

absl::Status FillAndCheck(v1::TemplateBundle& bundle, Trial trial,
                          const std::function<bool()>& is_given_up,
                          const Parametrize& parametrize) {
  const v1::Template& message = bundle.template_();
  const absl::Status completed = message.kind_case() == v1::Template::KIND_NOT_SET
                                     ? CompleteParts(bundle)
                                     : CompleteKind(bundle, trial, {parametrize, is_given_up});
  MORTISE_RETURN_IF_ERROR(CombineViolations(completed, KnowsParameters(message, completed)
                                                           ? CheckCustomMetrics(message)
                                                           : absl::OkStatus()));
  bundle.mutable_template_()->set_digest(parametric::BundleDigest(bundle));
  return absl::OkStatus();
}

std::set<std::string> ItemsOf(const v1::Template& message) {
  std::set<std::string> names;
  const auto add = [&names](const auto& owner) {
    names.insert(owner.item());
    for (const v1::ConditionalItem& item : owner.items()) names.insert(item.item());
  };
  std::for_each(message.parts().begin(), message.parts().end(), add);
  std::for_each(message.connections().begin(), message.connections().end(), add);
  return names;
}

std::set<std::string> MaterialsOf(const v1::Template& message) {
  if (message.has_cad()) return {message.cad().material()};
  if (message.has_cage()) return {message.cage().material()};
  return {};
}

v1::Template SummaryOf(v1::Template message) {
  message.clear_parts();
  message.clear_connections();
  message.clear_boundary_conditions();
  message.clear_reference_temperature();
  message.clear_metric_definitions();
  for (v1::HeightField& heights : *message.mutable_height_fields()) heights.clear_heights();
  if (message.has_cad()) message.mutable_cad()->Clear();
  if (message.has_cage()) message.mutable_cage()->Clear();
  if (message.has_assembly()) message.mutable_assembly()->clear_handles();
  return message;
}

}  // namespace mortise::templates
