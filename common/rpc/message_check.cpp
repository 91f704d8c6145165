#include "common/rpc/message_check.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::rpc {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

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

absl::Status CheckFinite(double value) {
  if (std::isfinite(value)) return absl::OkStatus();
  return InvalidField("", "must be a finite number");
}

// A failure has the path below this place as its field; the caller puts the rest before it.
absl::Status CheckPlace(const Place& place) {
  switch (place.field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return CheckFinite(place.Double());
    case FieldDescriptor::CPPTYPE_FLOAT:
      return CheckFinite(place.Float());
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int value = place.Enum();
      if (place.field->enum_type()->FindValueByNumber(value) != nullptr) return absl::OkStatus();
      return InvalidField(
          "", absl::StrCat(value, " is not a value of ", place.field->enum_type()->name()));
    }
    default:
      return CheckMessage(place.Nested());
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

// Rebuilds the failure with `segment` before its path, and its message after that.
absl::Status Locate(const std::string& segment, const absl::Status& status) {
  const std::string below = DetailOf(status).field;
  std::string message(status.message());
  message.erase(0, absl::StrCat(below, ": ").size());
  return InvalidField(below.empty() ? segment : absl::StrCat(segment, ".", below), message);
}

// Element `index` of a field, or the whole of a singular one (-1).
absl::Status CheckElement(const Message& message, const FieldDescriptor* field, int index) {
  if (!field->is_map()) {
    const absl::Status status = CheckPlace({message, field, index});
    return status.ok() ? status : Locate(Segment(field, index), status);
  }
  const Message& entry = message.GetReflection()->GetRepeatedMessage(message, field, index);
  const FieldDescriptor* value = entry.GetDescriptor()->map_value();
  if (!NeedsCheck(value)) return absl::OkStatus();
  const absl::Status status = CheckPlace({entry, value, -1});
  return status.ok() ? status : Locate(MapSegment(field, entry), status);
}

}  // namespace

absl::Status CheckMessage(const Message& message) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (!NeedsCheck(field)) continue;
    if (!field->is_repeated()) {
      MORTISE_RETURN_IF_ERROR(CheckElement(message, field, -1));
      continue;
    }
    const int count = message.GetReflection()->FieldSize(message, field);
    for (int i = 0; i < count; ++i) MORTISE_RETURN_IF_ERROR(CheckElement(message, field, i));
  }
  return absl::OkStatus();
}

}  // namespace mortise::rpc
