#include "services/catalog/template_cache.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/templates/template_codec.h"

namespace mortise::catalog {

absl::StatusOr<std::shared_ptr<const templates::Template>> TemplateCache::Compile(
    const v1::TemplateBundle& bundle) {
  const v1::Template& message = bundle.template_();
  const std::string key =
      absl::StrCat(message.name(), "/", message.revision(), "/", message.digest());
  if (auto found = compiled_.Find(key)) return *std::move(found);
  MORTISE_ASSIGN_OR_RETURN(auto compiled, templates::Compile(bundle));
  compiled_.Add(key, compiled);
  return compiled;
}

}  // namespace mortise::catalog
