#include "services/catalog/template_cache.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/template_codec.h"

namespace mortise::catalog {

absl::StatusOr<parametric::TemplateFunction> TemplateCache::Compile(
    const v1::TemplateBundle& bundle) {
  const v1::Template& message = bundle.template_();
  const std::string key =
      absl::StrCat(message.name(), "/", message.revision(), "/", message.digest());
  if (auto found = compiled_.Find(key)) return *std::move(found);
  MORTISE_ASSIGN_OR_RETURN(const parametric::TemplateBundle converted,
                           parametric::FromProto(bundle));
  MORTISE_ASSIGN_OR_RETURN(parametric::TemplateFunction function,
                           parametric::TemplateFunction::Create(converted));
  compiled_.Add(key, function);
  return function;
}

}  // namespace mortise::catalog
