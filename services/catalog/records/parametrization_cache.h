// Assemblies, parametrised: each content once, whoever asks first. The loader of the collection,
// imports, AssemblyService and templates share one. Thread safe.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/trial/search_outcome.h"
#include "common/base/single_flight_cache.h"
#include "common/store/store.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/records/search_records.h"

namespace mortise::catalog {

class ParametrizationCache {
 public:
  // `capacity`, bytes; see SingleFlightCache. What the searches come to is kept in the store
  // (search_records.h), which outlives this; nowhere if there is none.
  explicit ParametrizationCache(std::size_t capacity, store::Store* store = nullptr)
      : store_(store), parametrized_(capacity, Oversize::kAlone) {}

  // Returns the assembly of a frozen bundle, by its name and digest: from before, or parametrised
  // now, once for all who ask. `complete` adds what that takes and the bundle need not have: its
  // shapes. With a `group`, the sub-tree below it. Fails as `complete`, CheckShapesTogether and
  // parametric::Parametrize do.
  absl::StatusOr<templates::Parametrization> Get(
      v1::AssemblyBundle bundle, const std::function<bool()>& is_given_up,
      const std::function<absl::Status(v1::AssemblyBundle&)>& complete,
      const std::string& group = "");

  // The same of a bundle that has all that it is to have; one that lacks shapes is told so anew.
  // `progress` is told how far the searches are, of what is parametrised for this call.
  absl::StatusOr<templates::Parametrization> Get(const v1::AssemblyBundle& bundle,
                                                 const std::function<bool()>& is_given_up,
                                                 const std::string& group = "",
                                                 const parametric::SearchProgress& progress = {});

  // Keeps what the searches came to for those who asked within a transaction, as who loads a
  // collection does; after it, on any thread.
  void KeepWhatWasFound();

  // Get for templates; the cache outlives it.
  templates::Parametrize ForTemplates();

 private:
  // Parametrises now, with what the searches came to before if that is known.
  absl::StatusOr<templates::Parametrization> Make(const v1::AssemblyBundle& bundle,
                                                  const std::function<bool()>& is_given_up,
                                                  const std::string& group,
                                                  const parametric::SearchProgress& progress);
  absl::StatusOr<templates::Parametrization> Find(
      v1::AssemblyBundle bundle, const std::function<bool()>& is_given_up,
      const std::function<absl::Status(v1::AssemblyBundle&)>& complete, const std::string& group,
      const parametric::SearchProgress& progress);

  // Keeps it now, or notes it for KeepWhatWasFound.
  void Keep(const Searched& searched, const templates::Parametrization& made);

  store::Store* const store_;
  std::mutex mutex_;
  std::vector<std::pair<Searched, templates::Parametrization>> unkept_;  // guarded by mutex_
  SingleFlightCache<templates::Parametrization> parametrized_;
};

}  // namespace mortise::catalog
