#include "services/catalog/records/parametrization_cache.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/memory_use.h"
#include "common/base/errors.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {

namespace {

using templates::Parametrization;

// A digest says nothing of the assembly's name, which is checked as well, nor whether the shapes
// are there that it names.
std::string KeyOf(const v1::Assembly& assembly, const std::string& group) {
  return absl::StrCat(assembly.name(), "/", assembly.digest(), "/", group);
}

absl::StatusOr<Parametrization> ParametrizeNow(const v1::AssemblyBundle& bundle,
                                               const std::function<bool()>& is_given_up,
                                               const std::string& group) {
  MORTISE_RETURN_IF_ERROR(CheckShapesTogether(bundle.shapes()));
  return parametric::Parametrize(bundle, is_given_up, group);
}

}  // namespace

absl::StatusOr<Parametrization> ParametrizationCache::Get(
    v1::AssemblyBundle bundle, const std::function<bool()>& is_given_up,
    const std::function<absl::Status(v1::AssemblyBundle&)>& complete, const std::string& group) {
  using Made = SingleFlightCache<Parametrization>::Made;
  return parametrized_.Get(KeyOf(bundle.assembly(), group), [&]() -> absl::StatusOr<Made> {
    MORTISE_RETURN_IF_ERROR(complete(bundle));
    MORTISE_ASSIGN_OR_RETURN(Parametrization made, ParametrizeNow(bundle, is_given_up, group));
    const std::size_t bytes = parametric::MemoryUse(*made);
    return Made{std::move(made), bytes};
  });
}

absl::StatusOr<Parametrization> ParametrizationCache::Get(const v1::AssemblyBundle& bundle,
                                                          const std::function<bool()>& is_given_up,
                                                          const std::string& group) {
  if (!MissingShapes(bundle.assembly(), bundle.items(), bundle.shapes()).empty()) {
    return ParametrizeNow(bundle, is_given_up, group);
  }
  return Get(
      bundle, is_given_up, [](v1::AssemblyBundle&) { return absl::OkStatus(); }, group);
}

templates::Parametrize ParametrizationCache::ForTemplates() {
  return [this](const v1::AssemblyBundle& bundle, const std::function<bool()>& is_given_up,
                const std::string& group) { return Get(bundle, is_given_up, group); };
}

}  // namespace mortise::catalog
