#include "services/simulator/worker/analysis_setup.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/violation_lists.h"
#include "common/design/boundary_condition.h"
#include "common/expressions/identifier.h"
#include "common/files/template_codec.h"

namespace mortise::simulator {
namespace {

using parametric::BoundaryConditionKind;
using parametric::EvaluatedBoundaryCondition;
using parametric::EvaluatedDesign;
using parametric::EvaluatedPart;

constexpr int kMostConditions = 200;
constexpr std::size_t kLongestName = 500;  // bytes, of a part or face
constexpr const char* kField = "setup.boundary_conditions";

// What all faces of a part are called; one of a shape may have several names.
std::vector<std::string> FacesOf(const EvaluatedPart& part) {
  std::vector<std::string> names = part.face_names;
  if (!part.faceted) return names;
  for (const auto& of_face : part.faceted->face_names) {
    names.insert(names.end(), of_face.begin(), of_face.end());
  }
  return names;
}

// The names of those parts that bear.
std::vector<std::string> BearingParts(const EvaluatedDesign& design) {
  std::vector<std::string> names;
  for (const EvaluatedPart& part : design.parts) {
    if (!part.connecting) names.push_back(part.name);
  }
  return names;
}

// A number of a condition, and the field that says it.
struct Number {
  const char* field;
  std::optional<double> value;
};

// The numbers of a condition in the order of ComponentsOf.
std::vector<Number> NumbersOf(const EvaluatedBoundaryCondition& condition) {
  switch (condition.kind) {
    case BoundaryConditionKind::kFixed:
    case BoundaryConditionKind::kSymmetric:
      return {};
    case BoundaryConditionKind::kForce:
      return {{"force.x", condition.force.x()},
              {"force.y", condition.force.y()},
              {"force.z", condition.force.z()}};
    case BoundaryConditionKind::kPressure:
      return {{"pressure", condition.pressure}};
    case BoundaryConditionKind::kHeatFlux:
      return {{"heat_flux", condition.heat_flux}};
    case BoundaryConditionKind::kTemperature:
      return {{"temperature", condition.temperature}};
    case BoundaryConditionKind::kConvection:
      return {{"coefficient", condition.coefficient}, {"temperature", condition.temperature}};
    case BoundaryConditionKind::kDisplacement:
      return {{"displacement.x", condition.displacement[0]},
              {"displacement.y", condition.displacement[1]},
              {"displacement.z", condition.displacement[2]}};
    case BoundaryConditionKind::kGravity:
      return {{"acceleration.x", condition.acceleration.x()},
              {"acceleration.y", condition.acceleration.y()},
              {"acceleration.z", condition.acceleration.z()}};
    case BoundaryConditionKind::kRotation:
      return {{"axis_point.x", condition.axis_point.x()},
              {"axis_point.y", condition.axis_point.y()},
              {"axis_point.z", condition.axis_point.z()},
              {"angular_velocity.x", condition.angular_velocity.x()},
              {"angular_velocity.y", condition.angular_velocity.y()},
              {"angular_velocity.z", condition.angular_velocity.z()}};
  }
  return {};
}

// Reads the conditions of one setup, and what is wrong with them.
class Reader {
 public:
  explicit Reader(const EvaluatedDesign& design) : design_(design) {
    for (const EvaluatedBoundaryCondition& condition : design.boundary_conditions) {
      names_.insert(condition.name);
      uses_.push_back({condition.kind, condition.load_case});
    }
  }

  void Read(int index, const v1::EvaluatedBoundaryCondition& message) {
    const std::string field = absl::StrCat(kField, "[", index, "]");
    absl::StatusOr<EvaluatedBoundaryCondition> condition = parametric::FromProto(message, field);
    if (!condition.ok()) {
      for (FieldViolation& fault : AllViolationsOf(condition.status())) {
        findings_.push_back(std::move(fault));
      }
      return;
    }
    Name(field, index, *condition);
    Locate(field, *condition);
    CheckStrangers(field, message);
    CheckNumbers(field, *condition);
    uses_.push_back({condition->kind, condition->load_case});
    conditions_.push_back(*std::move(condition));
  }

  // Checks all together, with the reference temperature that then counts.
  void CheckTogether(const std::optional<double>& reference_temperature) {
    std::vector<FieldViolation> together;
    parametric::CheckConditionsTogether(kField, uses_, reference_temperature ? "given" : "",
                                        together);
    if (reference_temperature) {
      const std::string fault = parametric::FaultOfTemperature(*reference_temperature);
      if (!fault.empty()) together.push_back({"reference_temperature", fault});
    }
    for (FieldViolation& fault : together) {
      if (fault.field == "reference_temperature") fault.field = "setup.reference_temperature";
      findings_.push_back(std::move(fault));
    }
  }

  absl::Status status() const {
    return findings_.empty() ? absl::OkStatus() : InvalidFields(findings_);
  }

  std::vector<EvaluatedBoundaryCondition> TakeConditions() { return std::move(conditions_); }

 private:
  void Report(std::string field, std::string message) {
    findings_.push_back({std::move(field), std::move(message)});
  }

  void Name(const std::string& field, int index, EvaluatedBoundaryCondition& condition) {
    if (condition.name.empty()) condition.name = absl::StrCat("setup_", index + 1);
    if (!parametric::IsIdentifier(condition.name)) {
      Report(field + ".name",
             absl::StrCat("'", condition.name.substr(0, 80), "' is not an identifier"));
    } else if (!names_.insert(condition.name).second) {
      Report(field + ".name", absl::StrCat("'", condition.name, "' is there already"));
    }
  }

  // Finds the part that a face is of, and the face.
  void Locate(const std::string& field, EvaluatedBoundaryCondition& condition) {
    if (!parametric::ActsOnFace(condition.kind)) {
      if (!condition.part.empty() || !condition.face.empty()) {
        Report(field + ".face", "must be left out: it acts on the whole body");
      }
      return;
    }
    if (condition.face.empty()) return Report(field + ".face", "is missing");
    if (std::max(condition.part.size(), condition.face.size()) > kLongestName) {
      return Report(field + ".face", absl::StrCat("is longer than ", kLongestName, " bytes"));
    }
    const std::vector<std::string> parts = BearingParts(design_);
    if (condition.part.empty()) TakePartOfFace(parts, condition);
    if (condition.part.empty()) {
      return Report(field + ".face",
                    absl::StrCat("'", condition.face, "' is of no part: write PART/FACE",
                                 NamesOffered(condition.face, parts)));
    }
    if (std::find(parts.begin(), parts.end(), condition.part) == parts.end()) {
      return Report(field + ".part",
                    absl::StrCat("there is no part '", condition.part, "' that bears",
                                 NamesOffered(condition.part, parts)));
    }
    const int part = parametric::FindPart(design_, condition.part);
    const auto faces = FacesOf(design_.parts[static_cast<std::size_t>(part)]);
    if (std::find(faces.begin(), faces.end(), condition.face) != faces.end()) return;
    Report(field + ".face", absl::StrCat("part '", condition.part, "' has no face '",
                                         condition.face, "'", NamesOffered(condition.face, faces)));
  }

  // "seat/z_max", or the face of the only part.
  static void TakePartOfFace(const std::vector<std::string>& parts,
                             EvaluatedBoundaryCondition& condition) {
    const std::size_t slash = condition.face.find('/');
    if (slash != std::string::npos) {
      condition.part = condition.face.substr(0, slash);
      condition.face.erase(0, slash + 1);
    } else if (parts.size() == 1) {
      condition.part = parts.front();
    }
  }

  // Reports numbers that a kind has no use for: a force of what is said to be a pressure. Zeros are
  // what EvaluateTemplate writes where there is none.
  void CheckStrangers(const std::string& field, const v1::EvaluatedBoundaryCondition& message) {
    using Kind = v1::BoundaryCondition;
    const auto check = [&](const char* name, bool is_given, std::initializer_list<int> kinds) {
      if (!is_given || std::find(kinds.begin(), kinds.end(), message.kind()) != kinds.end()) return;
      Report(absl::StrCat(field, ".", name),
             absl::StrCat("is nothing that ", Kind::Kind_Name(message.kind()), " has"));
    };
    const auto is_nonzero = [](const v1::Vector3& vector) {
      return vector.x() != 0 || vector.y() != 0 || vector.z() != 0;
    };
    check("force", is_nonzero(message.force()), {Kind::FORCE});
    check("pressure", message.pressure() != 0, {Kind::PRESSURE});
    check("acceleration", is_nonzero(message.acceleration()), {Kind::GRAVITY});
    check("axis_point", is_nonzero(message.axis_point()), {Kind::ROTATION});
    check("angular_velocity", is_nonzero(message.angular_velocity()), {Kind::ROTATION});
    check("heat_flux", message.heat_flux() != 0, {Kind::HEAT_FLUX});
    check("temperature", message.temperature() != 0, {Kind::TEMPERATURE, Kind::CONVECTION});
    check("coefficient", message.coefficient() != 0, {Kind::CONVECTION});
    check("displacement", message.has_displacement(), {Kind::DISPLACEMENT});
  }

  void CheckNumbers(const std::string& field, const EvaluatedBoundaryCondition& condition) {
    const std::vector<Number> numbers = NumbersOf(condition);
    const auto components = parametric::ComponentsOf(condition.kind);
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::optional<double>& value = numbers[i].value;
      texts.emplace_back(value ? "given" : "");
      if (!value) continue;
      const std::string fault = std::isfinite(*value) ? parametric::FaultOf(components[i], *value)
                                                      : std::string("is not a finite number");
      if (!fault.empty()) Report(absl::StrCat(field, ".", numbers[i].field), fault);
    }
    parametric::CheckCondition(field, condition.kind, texts, condition.load_case, findings_);
  }

  const EvaluatedDesign& design_;
  std::set<std::string> names_;
  std::vector<parametric::ConditionUse> uses_;
  std::vector<EvaluatedBoundaryCondition> conditions_;
  std::vector<FieldViolation> findings_;
};

}  // namespace

absl::Status AddSetup(v1::AnalysisSetup& setup, EvaluatedDesign& design) {
  if (setup.boundary_conditions_size() > kMostConditions) {
    return InvalidField(kField, absl::StrCat("are more than ", kMostConditions));
  }
  std::optional<double> reference = design.reference_temperature;
  if (setup.has_reference_temperature()) reference = setup.reference_temperature();
  Reader reader(design);
  for (int i = 0; i < setup.boundary_conditions_size(); ++i) {
    reader.Read(i, setup.boundary_conditions(i));
  }
  // A temperature of the template's own may be for conditions that this design does not have.
  reader.CheckTogether(setup.has_reference_temperature() ? reference : std::nullopt);
  MORTISE_RETURN_IF_ERROR(reader.status());
  std::vector<EvaluatedBoundaryCondition> conditions = reader.TakeConditions();
  for (int i = 0; i < setup.boundary_conditions_size(); ++i) {
    v1::EvaluatedBoundaryCondition& message = *setup.mutable_boundary_conditions(i);
    const EvaluatedBoundaryCondition& read = conditions[static_cast<std::size_t>(i)];
    message.set_name(read.name);
    message.set_part(read.part);
    message.set_face(read.face);
  }
  design.boundary_conditions.insert(design.boundary_conditions.end(),
                                    std::make_move_iterator(conditions.begin()),
                                    std::make_move_iterator(conditions.end()));
  design.reference_temperature = reference;
  return absl::OkStatus();
}

}  // namespace mortise::simulator
