// Assemblies from the store, and what is made of them, which the catalog keeps.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog {

// As GetAssemblyBundle.
absl::StatusOr<v1::AssemblyBundle> FindAssembly(const Catalog& catalog, const std::string& name,
                                                int64_t revision);

// An assembly revision, parametrised.
struct ParametrizedAssembly {
  v1::AssemblyBundle bundle;
  templates::Parametrization parametrized;
};
// Parametrised now, once for all who ask, or before. CANCELLED if the caller goes.
absl::StatusOr<ParametrizedAssembly> FindParametrized(Catalog& catalog, const rpc::Call& call,
                                                      const std::string& name, int64_t revision);

// Return the items and materials that a bundle has.
absl::StatusOr<parametric::TemplateBundle> UsedBy(const v1::AssemblyBundle& bundle);

}  // namespace mortise::catalog
