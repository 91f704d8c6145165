// Compiled templates, kept so that dragging a slider does not compile one a move. Thread safe.
#pragma once

#include <list>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "common/parametric/evaluation.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

class TemplateCache {
 public:
  explicit TemplateCache(std::size_t capacity) : capacity_(capacity) {}

  // F of the bundle, compiled now or found by name, revision and digest.
  absl::StatusOr<parametric::TemplateFunction> Compile(const v1::TemplateBundle& bundle);

 private:
  const std::size_t capacity_;
  std::mutex mutex_;
  // Most recently used first; guarded by mutex_.
  std::list<std::pair<std::string, parametric::TemplateFunction>> entries_;
};

}  // namespace mortise::catalog
