#include "common/messages/message_words.h"

#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/names/offered_names.h"

namespace mortise {

std::string ValueNames(const google::protobuf::EnumDescriptor& type) {
  std::string names;
  for (int i = 1; i < type.value_count(); ++i) {
    absl::StrAppend(&names, i == 1 ? "" : ", ", type.value(i)->name());
  }
  return names;
}

std::string ChoiceNames(const google::protobuf::OneofDescriptor& choice) {
  std::string names;
  for (int i = 0; i < choice.field_count(); ++i) {
    absl::StrAppend(&names, i == 0 ? "" : ", ", choice.field(i)->name());
  }
  return names;
}

std::string FieldsOffered(const std::string& name, const google::protobuf::Descriptor& type) {
  std::vector<std::string> fields;
  for (int i = 0; i < type.field_count(); ++i) fields.push_back(type.field(i)->name());
  return NamesOffered(name, fields);
}

bool HasSpecialJson(const google::protobuf::Descriptor& type) {
  return absl::StartsWith(type.full_name(), "google.protobuf.");
}

std::string WantedValue(const google::protobuf::FieldDescriptor& field, Notation notation) {
  using google::protobuf::FieldDescriptor;
  const bool is_json = notation == Notation::kJson;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_ENUM:
      return absl::StrCat("must be one of ", ValueNames(*field.enum_type()));
    case FieldDescriptor::CPPTYPE_BOOL:
      return "must be true or false";
    case FieldDescriptor::CPPTYPE_STRING:
      if (!is_json) return "must be a text in quotes";
      return field.type() == FieldDescriptor::TYPE_BYTES ? "must be a text in base64"
                                                         : "must be a text";
    case FieldDescriptor::CPPTYPE_MESSAGE:
      if (!is_json) return "must be fields in { }";
      return HasSpecialJson(*field.message_type())
                 ? absl::StrCat("must be a ", field.message_type()->full_name(), " as JSON")
                 : "must be an object";
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT:
      return "must be a number";
    default:
      return "must be a whole number that is not too large";
  }
}

}  // namespace mortise
