// A small list in the order of use.
#include "services/catalog/template_cache.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/template_codec.h"

namespace mortise::catalog {

absl::StatusOr<parametric::TemplateFunction> TemplateCache::Compile(
    const v1::TemplateBundle& bundle) {
  const v1::Template& message = bundle.template_();
  const std::string key =
      absl::StrCat(message.name(), "/", message.revision(), "/", message.digest());
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&key](const auto& entry) { return entry.first == key; });
    if (found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
      return found->second;
    }
  }
  MORTISE_ASSIGN_OR_RETURN(const parametric::TemplateBundle converted,
                           parametric::FromProto(bundle));
  MORTISE_ASSIGN_OR_RETURN(parametric::TemplateFunction function,
                           parametric::TemplateFunction::Create(converted));
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_.emplace_front(key, function);
  if (entries_.size() > capacity_) entries_.pop_back();
  return function;
}

}  // namespace mortise::catalog
