// Compiled templates, kept so that dragging a slider does not compile one a move. Thread safe.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

class TemplateCache {
 public:
  // `capacity`, bytes; see SingleFlightCache. Assemblies are parametrised by `parametrize`.
  TemplateCache(std::size_t capacity, templates::Parametrize parametrize)
      : parametrize_(std::move(parametrize)), compiled_(capacity, Oversize::kAlone) {}

  // F of the bundle, by name, revision and digest: from before, or compiled now, once for all who
  // ask. `complete` adds what compiling takes and the bundle need not have: its shapes. Fails as it
  // and templates::Compile do.
  absl::StatusOr<std::shared_ptr<const templates::Template>> Get(
      v1::TemplateBundle bundle, const std::function<absl::Status(v1::TemplateBundle&)>& complete);

 private:
  const templates::Parametrize parametrize_;
  SingleFlightCache<std::shared_ptr<const templates::Template>> compiled_;
};

}  // namespace mortise::catalog
