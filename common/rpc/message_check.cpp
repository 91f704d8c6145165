#include "common/rpc/message_check.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/field_violations.h"

namespace mortise::rpc {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr std::size_t kMost = 40;  // violations, about as many as an answer holds

// One field of a message, or one element of a repeated field (`index` >= 0).
struct Place {
  const Message& message;
  const FieldDescriptor* field;
  int index;

  const Reflection& reflection() const { return *message.GetReflection(); }

  double Double() const {
    return index < 0 ? reflection().GetDouble(message, field)
                     : reflection().GetRepeatedDouble(message, field, index);
  }
  float Float() const {
    return index < 0 ? reflection().GetFloat(message, field)
                     : reflection().GetRepeatedFloat(message, field, index);
  }
  int Enum() const {
    return index < 0 ? reflection().GetEnumValue(message, field)
                     : reflection().GetRepeatedEnumValue(message, field, index);
  }
  const Message& Nested() const {
    return index < 0 ? reflection().GetMessage(message, field)
                     : reflection().GetRepeatedMessage(message, field, index);
  }
};

bool NeedsCheck(const FieldDescriptor* field) {
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT:
    case FieldDescriptor::CPPTYPE_ENUM:
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return true;
    default:
      return false;
  }
}

using Violations = std::vector<FieldViolation>;

void CheckInto(const Message& message, Violations& violations);

// Whether no number says that nothing is known, as the contract has it.
bool MayBeUnknown(const FieldDescriptor* field) {
  return field->full_name() == "mortise.v1.HeightGrid.heights";
}

void CheckFinite(const FieldDescriptor* field, double value, Violations& violations) {
  if (std::isfinite(value) || (std::isnan(value) && MayBeUnknown(field))) return;
  violations.push_back({"", "must be a finite number"});
}

// Violations have the path below this place as their fields; the caller puts the rest before it.
void CheckPlace(const Place& place, Violations& violations) {
  switch (place.field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return CheckFinite(place.field, place.Double(), violations);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return CheckFinite(place.field, place.Float(), violations);
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int value = place.Enum();
      if (place.field->enum_type()->FindValueByNumber(value) != nullptr) return;
      violations.push_back(
          {"", absl::StrCat(value, " is not a value of ", place.field->enum_type()->name())});
      return;
    }
    default:
      CheckInto(place.Nested(), violations);
  }
}

std::string Segment(const FieldDescriptor* field, int index) {
  return index < 0 ? field->name() : absl::StrCat(field->name(), "[", index, "]");
}

// A map's entry is named by its key: limits["width"].
std::string MapSegment(const FieldDescriptor* field, const Message& entry) {
  std::string key;
  google::protobuf::TextFormat::PrintFieldValueToString(entry, entry.GetDescriptor()->map_key(), -1,
                                                        &key);
  return absl::StrCat(field->name(), "[", key, "]");
}

// Puts `segment` before the paths of the violations from the index `first` on.
void Locate(const std::string& segment, std::size_t first, Violations& violations) {
  for (std::size_t i = first; i < violations.size(); ++i) {
    std::string& field = violations[i].field;
    field = absl::StrCat(segment, field.empty() ? "" : ".", field);
  }
}

// Element `index` of a field, or the whole of a singular one (-1).
void CheckElement(const Message& message, const FieldDescriptor* field, int index,
                  Violations& violations) {
  const std::size_t first = violations.size();
  if (!field->is_map()) {
    CheckPlace({message, field, index}, violations);
    if (violations.size() > first) Locate(Segment(field, index), first, violations);
    return;
  }
  const Message& entry = message.GetReflection()->GetRepeatedMessage(message, field, index);
  const FieldDescriptor* value = entry.GetDescriptor()->map_value();
  if (!NeedsCheck(value)) return;
  CheckPlace({entry, value, -1}, violations);
  if (violations.size() > first) Locate(MapSegment(field, entry), first, violations);
}

void CheckInto(const Message& message, Violations& violations) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (!NeedsCheck(field)) continue;
    if (!field->is_repeated()) {
      CheckElement(message, field, -1, violations);
      continue;
    }
    const int count = message.GetReflection()->FieldSize(message, field);
    for (int i = 0; i < count && violations.size() < kMost; ++i) {
      CheckElement(message, field, i, violations);
    }
    if (violations.size() >= kMost) return;
  }
}

}  // namespace

absl::Status CheckMessage(const Message& message) {
  Violations violations;
  CheckInto(message, violations);
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

}  // namespace mortise::rpc
