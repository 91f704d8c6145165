#include "services/catalog/template_cache.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/templates/template_codec.h"

namespace mortise::catalog {

namespace {

std::string KeyOf(const v1::Template& message) {
  return absl::StrCat(message.name(), "/", message.revision(), "/", message.digest());
}

}  // namespace

std::shared_ptr<const templates::Template> TemplateCache::Find(const v1::TemplateBundle& bundle) {
  return compiled_.Find(KeyOf(bundle.template_())).value_or(nullptr);
}

absl::StatusOr<std::shared_ptr<const templates::Template>> TemplateCache::Compile(
    const v1::TemplateBundle& bundle) {
  if (auto found = Find(bundle)) return found;
  MORTISE_ASSIGN_OR_RETURN(auto compiled, templates::Compile(bundle));
  compiled_.Add(KeyOf(bundle.template_()), compiled);
  return compiled;
}

}  // namespace mortise::catalog
