#include "common/templates/unbuilt_fields.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/template_validation.h"

namespace mortise::templates {
namespace {

using Unbuilt = std::vector<std::string>;  // paths of fields, in order

void Add(bool is_given, const std::string& field, Unbuilt& unbuilt) {
  if (is_given) unbuilt.push_back(field);
}

template <typename Parameters>
void AddParameters(const Parameters& parameters, const std::string& kind, Unbuilt& unbuilt) {
  for (int i = 0; i < parameters.size(); ++i) {
    Add(parameters[i].choices_size() > 0, absl::StrCat(kind, "parameters[", i, "].choices"),
        unbuilt);
  }
}

void AddParts(const v1::Template& message, Unbuilt& unbuilt) {
  for (int i = 0; i < message.parts_size(); ++i) {
    const v1::PartTemplate& part = message.parts(i);
    const std::string path = absl::StrCat("parts[", i, "]");
    Add(!part.present().empty(), path + ".present", unbuilt);
    Add(part.repeat_size() > 0, path + ".repeat", unbuilt);
    Add(part.items_size() > 0, path + ".items", unbuilt);
  }
}

void AddConnections(const v1::Template& message, Unbuilt& unbuilt) {
  for (int i = 0; i < message.connections_size(); ++i) {
    const v1::Connection& connection = message.connections(i);
    const std::string path = absl::StrCat("connections[", i, "]");
    Add(!connection.present().empty(), path + ".present", unbuilt);
    Add(connection.pairing() != v1::Connection::PAIRING_UNSPECIFIED, path + ".pairing", unbuilt);
    Add(connection.items_size() > 0, path + ".items", unbuilt);
    Add(connection.row_spacing() != 0, path + ".row_spacing", unbuilt);
    Add(connection.side_distance() != 0, path + ".side_distance", unbuilt);
  }
}

// Of conditions and features.
template <typename Entries>
void AddPresent(const Entries& entries, const std::string& list, Unbuilt& unbuilt) {
  for (int i = 0; i < entries.size(); ++i) {
    Add(!entries[i].present().empty(), absl::StrCat(list, "[", i, "].present"), unbuilt);
  }
}

}  // namespace

absl::Status CheckNoUnbuiltFields(const v1::Template& message) {
  Unbuilt unbuilt;
  AddParameters(message.parameters(), "", unbuilt);
  AddParameters(message.cad().parameters(), "cad.", unbuilt);
  AddParameters(message.cage().parameters(), "cage.", unbuilt);
  AddParts(message, unbuilt);
  AddConnections(message, unbuilt);
  AddPresent(message.boundary_conditions(), "boundary_conditions", unbuilt);
  AddPresent(message.cad().features(), "cad.features", unbuilt);
  AddPresent(message.cage().conditions(), "cage.conditions", unbuilt);
  return unbuilt.empty() ? absl::OkStatus() : NotBuilt(unbuilt.front());
}

absl::Status CheckNoChoices(
    const google::protobuf::RepeatedPtrField<v1::ParameterValue>& parameters) {
  std::vector<FieldViolation> findings;
  for (int i = 0; i < parameters.size(); ++i) {
    const v1::ParameterValue& given = parameters[i];
    if (given.choice().empty()) continue;
    findings.push_back({absl::StrCat("parameters[", i, "].choice"),
                        absl::StrCat("'", given.name(), "' is no choice, so it cannot be '",
                                     given.choice(), "'")});
  }
  return parametric::ToStatus(findings);
}

}  // namespace mortise::templates
