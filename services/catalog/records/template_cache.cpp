#include "services/catalog/records/template_cache.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::catalog {
namespace {

using Compiled = SingleFlightCache<std::shared_ptr<const templates::Template>>;

std::string KeyOf(const v1::Template& message) {
  return absl::StrCat(message.name(), "/", message.revision(), "/", message.digest());
}

}  // namespace

absl::StatusOr<std::shared_ptr<const templates::Template>> TemplateCache::Get(
    v1::TemplateBundle bundle, const std::function<absl::Status(v1::TemplateBundle&)>& complete) {
  return compiled_.Get(KeyOf(bundle.template_()), [&]() -> absl::StatusOr<Compiled::Made> {
    MORTISE_RETURN_IF_ERROR(complete(bundle));
    MORTISE_ASSIGN_OR_RETURN(auto compiled, templates::Compile(bundle, parametrize_));
    const std::size_t bytes = compiled->MemoryUse();
    return Compiled::Made{std::move(compiled), bytes};
  });
}

}  // namespace mortise::catalog
