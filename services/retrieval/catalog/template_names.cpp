#include "services/retrieval/catalog/template_names.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"

namespace mortise::retrieval {

absl::Status CheckTemplateNames(const google::protobuf::RepeatedPtrField<std::string>& templates) {
  constexpr int kMaxTemplates = 1000;
  if (templates.size() > kMaxTemplates) {
    return InvalidField("templates", absl::StrCat("has more than ", kMaxTemplates));
  }
  absl::Status status;
  for (int i = 0; i < templates.size(); ++i) {
    status = CombineViolations(
        status,
        ParseResourceName(templates[i], "templates", absl::StrCat("templates[", i, "]")).status());
  }
  return status;
}

std::string ShownName(const std::string& template_name, const std::string& group) {
  const std::string id = template_name.substr(template_name.find('/') + 1);
  return absl::StrCat(id, group.empty() ? "" : ", ", group);
}

}  // namespace mortise::retrieval
