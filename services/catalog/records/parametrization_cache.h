// Assemblies, parametrised: each content once, whoever asks first. The loader of the collection,
// imports, AssemblyService and templates share one. Thread safe.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

class ParametrizationCache {
 public:
  // `capacity`, bytes; see SingleFlightCache.
  explicit ParametrizationCache(std::size_t capacity) : parametrized_(capacity, Oversize::kAlone) {}

  // Returns the assembly of a frozen bundle, by its name and digest: from before, or parametrised
  // now, once for all who ask. `complete` adds what that takes and the bundle need not have: its
  // shapes. With a `group`, the sub-tree below it. Fails as `complete`, CheckShapesTogether and
  // parametric::Parametrize do.
  absl::StatusOr<templates::Parametrization> Get(
      v1::AssemblyBundle bundle, const std::function<bool()>& is_given_up,
      const std::function<absl::Status(v1::AssemblyBundle&)>& complete,
      const std::string& group = "");

  // The same of a bundle that has all that it is to have; one that lacks shapes is told so anew.
  absl::StatusOr<templates::Parametrization> Get(const v1::AssemblyBundle& bundle,
                                                 const std::function<bool()>& is_given_up,
                                                 const std::string& group = "");

  // Get for templates; the cache outlives it.
  templates::Parametrize ForTemplates();

 private:
  SingleFlightCache<templates::Parametrization> parametrized_;
};

}  // namespace mortise::catalog
