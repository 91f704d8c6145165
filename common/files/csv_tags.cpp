#include "common/files/csv_tags.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace mortise::parametric {

void ReadExternalIds(const std::string& text,
                     google::protobuf::RepeatedPtrField<std::string>* external_ids) {
  for (const absl::string_view entry : absl::StrSplit(text, ';')) {
    *external_ids->Add() = std::string(absl::StripAsciiWhitespace(entry));
  }
}

absl::Status ReadLabels(const std::string& text,
                        google::protobuf::Map<std::string, std::string>* labels) {
  for (const absl::string_view entry : absl::StrSplit(text, ';')) {
    const std::pair<absl::string_view, absl::string_view> parts =
        absl::StrSplit(entry, absl::MaxSplits('=', 1));
    const std::string key(absl::StripAsciiWhitespace(parts.first));
    if (labels->contains(key)) {
      return absl::InvalidArgumentError(
          absl::StrCat("the label '", key.substr(0, 80), "' is there twice"));
    }
    (*labels)[key] = std::string(absl::StripAsciiWhitespace(parts.second));
  }
  return absl::OkStatus();
}

}  // namespace mortise::parametric
