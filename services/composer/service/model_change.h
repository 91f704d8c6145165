// A change of a model between the work that it takes and its place in the store.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "services/composer/service/composer.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// What is stored of a change once the work is done.
struct ModelChange {
  v1::Model seen;    // the head of the model that it was worked on
  ModelState state;  // that came of it
  std::string step;  // for people: "add shelf"
  std::vector<std::shared_ptr<const Drawing>> drawings = {};  // that the model may not have yet
  bool preview = false;                                       // nothing is stored
};

// A model that is about to be changed.
struct ModelAtWork {
  v1::Model seen;
  OpenModel model;

  // Returns the change that it has gone through.
  ModelChange Done(std::string step,
                   std::vector<std::shared_ptr<const Drawing>> drawings = {}) const {
    return {seen, StateOf(model), std::move(step), std::move(drawings)};
  }
};

// Whether a request is content with a newer revision of its model.
template <typename Request>
bool MayRebase(const Request& asked) {
  if constexpr (requires { asked.rebase(); }) return asked.rebase();
  return false;
}

// What of its model a request names.
template <typename Request>
NamedNode NamedBy(const Request& asked) {
  NamedNode named;
  if constexpr (requires { asked.component(); }) named.component = asked.component();
  if constexpr (requires { asked.node(); }) {
    if (named.component.empty()) named.node = asked.node();
  }
  return named;
}

// Reads the model that a request names at the revision that its caller saw, or the newest if the
// request may be rebased. Fails as ReadModelAt and ReadModelSince.
template <typename Request>
absl::StatusOr<StoredModel> ReadFor(const Composer& composer, const Request& asked) {
  if (!MayRebase(asked)) return ReadModelAt(*composer.store, asked.name(), asked.revision());
  return ReadModelSince(*composer.store, asked.name(), asked.revision(), NamedBy(asked));
}

// Opens that model, until nobody waits for the call any more. Fails as ReadFor and Open.
template <typename Request>
absl::StatusOr<ModelAtWork> OpenFor(const Composer& composer, const rpc::Call& call,
                                    const Request& asked) {
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, ReadFor(composer, asked));
  MORTISE_ASSIGN_OR_RETURN(OpenModel model,
                           Open(stored, composer.drawings, [&call] { return call.cancelled(); }));
  return ModelAtWork{stored.head, std::move(model)};
}

// Stores a change, and returns the model as it then is. ABORTED, STALE_REVISION.
absl::StatusOr<v1::Model> StoreChange(store::Transaction& transaction, const ModelChange& change,
                                      const rpc::Call& call);

}  // namespace mortise::composer
