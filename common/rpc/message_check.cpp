#include "common/rpc/message_check.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

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

std::string Segment(const Place& place) {
  if (place.index < 0) return place.field->name();
  return absl::StrCat(place.field->name(), "[", place.index, "]");
}

// Rebuilds the failure with this place's segment before its path, and the message after it.
absl::Status Locate(const Place& place, const absl::Status& status) {
  const std::string below = DetailOf(status).field;
  const std::string old_prefix = absl::StrCat(below, ": ");
  std::string message(status.message());
  message.erase(0, old_prefix.size());
  const std::string path =
      below.empty() ? Segment(place) : absl::StrCat(Segment(place), ".", below);
  return InvalidField(path, message);
}

}  // namespace

absl::Status CheckMessage(const Message& message) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (!NeedsCheck(field)) continue;
    const bool repeated = field->is_repeated();
    const int count = repeated ? message.GetReflection()->FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
      const Place place{message, field, repeated ? i : -1};
      if (absl::Status status = CheckPlace(place); !status.ok()) return Locate(place, status);
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::rpc
