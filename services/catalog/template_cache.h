// Compiled templates, kept so that dragging a slider does not compile one a move. Thread safe.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/templates/template.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/recently_used.h"

namespace mortise::catalog {

class TemplateCache {
 public:
  explicit TemplateCache(std::size_t capacity) : compiled_(capacity) {}

  // F of the bundle if it was compiled lately, by name, revision and digest; else null. The bundle
  // needs no shapes.
  std::shared_ptr<const templates::Template> Find(const v1::TemplateBundle& bundle);

  // F of the bundle, compiled now or found.
  absl::StatusOr<std::shared_ptr<const templates::Template>> Compile(
      const v1::TemplateBundle& bundle);

 private:
  RecentlyUsed<std::shared_ptr<const templates::Template>> compiled_;
};

}  // namespace mortise::catalog
