#include "common/messages/message_words.h"

#include "absl/strings/str_cat.h"

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

}  // namespace mortise
