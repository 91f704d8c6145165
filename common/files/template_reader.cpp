#include "common/files/template_reader.h"

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/violation_lists.h"
#include "common/design/template_checks.h"
#include "common/files/axis_codec.h"
#include "common/files/height_field_codec.h"
#include "common/files/template_codec.h"

namespace mortise::parametric {
namespace {

using Findings = std::vector<FieldViolation>;

constexpr std::size_t kMaxFindings = 100;

// The value, or else `substitute` and a finding.
template <typename Value>
Value ValueOr(absl::StatusOr<Value> read, Value substitute, Findings& findings) {
  if (read.ok()) return *std::move(read);
  for (const FieldViolation& violation : AllViolationsOf(read.status())) {
    findings.push_back({violation.field, violation.message});
  }
  return substitute;
}

Extent ReadExtent(const v1::Extent& message) { return {message.from(), message.to()}; }

Prism ReadPrism(const v1::Prism& message, const std::string& field, Findings& findings) {
  Prism prism;
  prism.axis = ValueOr(AxisFromProto(message.axis(), field + ".axis"), Axis::kZ, findings);
  for (const v1::OutlinePoint& point : message.outline()) {
    prism.outline.push_back({point.u(), point.v()});
  }
  prism.extent = ReadExtent(message.extent());
  return prism;
}

decltype(PartTemplate::body) ReadBody(const v1::PartTemplate& message, const std::string& field,
                                      Findings& findings) {
  switch (message.body_case()) {
    case v1::PartTemplate::kBox:
      return Box{ReadExtent(message.box().x()), ReadExtent(message.box().y()),
                 ReadExtent(message.box().z())};
    case v1::PartTemplate::kPrism:
      return ReadPrism(message.prism(), field + ".prism", findings);
    case v1::PartTemplate::BODY_NOT_SET:
      break;
  }
  findings.push_back({field + ".body", "is missing: say 'box' or 'prism'"});
  return Box{};
}

std::vector<ConditionalItem> ReadItems(
    const google::protobuf::RepeatedPtrField<v1::ConditionalItem>& messages) {
  std::vector<ConditionalItem> items;
  for (const v1::ConditionalItem& message : messages) {
    items.push_back({message.when(), message.item()});
  }
  return items;
}

PartTemplate ReadPart(const v1::PartTemplate& message, const std::string& field,
                      Findings& findings) {
  PartTemplate part;
  part.name = message.name();
  part.title = message.title();
  part.item = message.item();
  part.length_axis =
      ValueOr(AxisFromProto(message.length_axis(), field + ".length_axis"), Axis::kX, findings);
  part.thickness_axis = ValueOr(AxisFromProto(message.thickness_axis(), field + ".thickness_axis"),
                                Axis::kZ, findings);
  part.body = ReadBody(message, field, findings);
  part.present = message.present();
  for (const v1::PartRepeat& repeat : message.repeat()) {
    part.repeat.push_back({repeat.count(), repeat.x(), repeat.y(), repeat.z(), repeat.index()});
  }
  part.items = ReadItems(message.items());
  return part;
}

Connection ReadConnection(const v1::Connection& message, const std::string& field,
                          Findings& findings) {
  Connection connection = {message.name(),         message.part(),    message.face(),
                           message.other_part(),   message.item(),    message.priority(),
                           message.end_distance(), message.spacing(), message.depth_in_part()};
  connection.present = message.present();
  if (v1::Connection::Pairing_IsValid(message.pairing())) {
    connection.pairing = static_cast<Pairing>(message.pairing());
  } else {
    findings.push_back({field + ".pairing", "must be BY_NUMBER or TOUCHING, or left out"});
  }
  connection.items = ReadItems(message.items());
  connection.row_spacing = message.row_spacing();
  connection.side_distance = message.side_distance();
  return connection;
}

BoundaryCondition ReadCondition(const v1::BoundaryCondition& message, const std::string& field,
                                Findings& findings) {
  BoundaryCondition unread;
  // Beside which everything may be.
  unread.kind = BoundaryConditionKind::kTemperature;
  unread.name = message.name();
  unread.present = message.present();
  unread.part = message.part();
  unread.face = message.face();
  return ValueOr(FromProto(message, field), std::move(unread), findings);
}

// Which findings about a template follow from what could not be read of it.
class Consequences {
 public:
  Consequences(const v1::Template& message, const Findings& unread) {
    for (const FieldViolation& finding : unread) unread_.insert(finding.field);
    for (int i = 0; i < message.parts_size(); ++i) AddPart(message.parts(i), i);
    for (int i = 0; i < message.connections_size(); ++i) {
      if (!bodiless_.contains(message.connections(i).part())) continue;
      fields_.insert(absl::StrCat("connections[", i, "].face"));
    }
    for (int i = 0; i < message.boundary_conditions_size(); ++i) {
      AddCondition(message.boundary_conditions(i), absl::StrCat("boundary_conditions[", i, "]"));
    }
  }

  bool Contains(const std::string& field) const {
    return fields_.contains(field) ||
           std::any_of(whole_.begin(), whole_.end(),
                       [&](const std::string& place) { return field.starts_with(place); });
  }

 private:
  bool IsUnread(const std::string& field) const { return unread_.contains(field); }

  void AddPart(const v1::PartTemplate& part, int index) {
    const std::string place = absl::StrCat("parts[", index, "]");
    const bool thickness = IsUnread(place + ".thickness_axis");
    if (thickness || IsUnread(place + ".length_axis")) fields_.insert(place + ".thickness_axis");
    if (thickness || IsUnread(place + ".prism.axis")) fields_.insert(place + ".prism.axis");
    if (!IsUnread(place + ".body")) return;
    bodiless_.insert(part.name());
    whole_.push_back(place + ".box.");
  }

  // Nobody knows what a condition of an unknown kind takes.
  void AddCondition(const v1::BoundaryCondition& condition, const std::string& place) {
    if (bodiless_.contains(condition.part())) fields_.insert(place + ".face");
    if (!IsUnread(place + ".kind")) return;
    for (const char* field : {".components", ".load_case", ".face"}) {
      whole_.push_back(place + field);
    }
    if (condition.part().empty()) fields_.insert(place + ".part");
  }

  std::set<std::string> unread_, bodiless_, fields_;
  std::vector<std::string> whole_;  // beginnings of fields
};

}  // namespace

TemplateDefinition ReadTemplate(const v1::Template& message,
                                std::vector<FieldViolation>& findings) {
  TemplateDefinition definition;
  definition.name = message.name();
  definition.revision = message.revision();
  definition.title = message.title();
  definition.description = message.description();
  definition.digest = message.digest();
  for (const v1::Parameter& parameter : message.parameters()) {
    definition.parameters.push_back(FromProto(parameter));
  }
  for (int i = 0; i < message.parts_size(); ++i) {
    definition.parts.push_back(
        ReadPart(message.parts(i), absl::StrCat("parts[", i, "]"), findings));
  }
  for (int i = 0; i < message.connections_size(); ++i) {
    definition.connections.push_back(
        ReadConnection(message.connections(i), absl::StrCat("connections[", i, "]"), findings));
  }
  for (int i = 0; i < message.boundary_conditions_size(); ++i) {
    definition.boundary_conditions.push_back(ReadCondition(
        message.boundary_conditions(i), absl::StrCat("boundary_conditions[", i, "]"), findings));
  }
  definition.reference_temperature = message.reference_temperature();
  definition.grounds = ReadGrounds(message.height_fields(), findings);
  return definition;
}

std::vector<FieldViolation> ValidateTemplateMessage(const v1::Template& message,
                                                    const std::vector<Item>& items,
                                                    const std::vector<Material>& materials) {
  std::vector<FieldViolation> findings;
  const TemplateBundle bundle = {ReadTemplate(message, findings), items, materials};
  if (findings.empty()) return ValidateTemplate(bundle);
  const Consequences consequences(message, findings);
  for (FieldViolation& finding : CheckTemplate(bundle)) {
    if (!consequences.Contains(finding.field)) findings.push_back(std::move(finding));
  }
  if (findings.size() > kMaxFindings) findings.resize(kMaxFindings);
  return findings;
}

}  // namespace mortise::parametric
