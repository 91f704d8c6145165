// Template revisions from the catalog, compiled, and kept by their content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/channel.h"
#include "common/templates/template.h"
#include "services/simulator/shape_source.h"

namespace mortise::v1 {
class TemplateBundle;
}

namespace mortise::simulator {

// A template revision ready for evaluation.
struct CompiledTemplate {
  std::string name;  // templates/{id}
  int64_t revision = 0;
  std::string digest;  // of its content and of the items and materials it uses
  // Whether the shapes of parts that an analysis joins have their exact surfaces.
  bool is_exact = false;
  std::size_t bytes = 0;  // of its shapes
  std::shared_ptr<const templates::Template> function;
};

// Thread safe.
class TemplateSource {
 public:
  // `capacity`: how many revisions are kept, the least recently used forgotten first; fewer if
  // their shapes are large.
  TemplateSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity);

  // The revision, or the latest for 0. Asks the catalog; compiles only what it has not seen.
  // INVALID_ARGUMENT naming "subject" for a malformed name; NOT_FOUND; UNAVAILABLE.
  absl::StatusOr<std::shared_ptr<const CompiledTemplate>> Get(const std::string& name,
                                                              int64_t revision,
                                                              const rpc::Origin& origin);

  // The same revision as a task names it, with the exact surfaces of parts that are joined; without
  // a question to the catalog if its content is known. FAILED_PRECONDITION, TEMPLATE_CHANGED if
  // items or materials have changed since; as ShapeSource::AddExact.
  absl::StatusOr<std::shared_ptr<const CompiledTemplate>> GetByDigest(const std::string& name,
                                                                      int64_t revision,
                                                                      const std::string& digest,
                                                                      const rpc::Origin& origin);

 private:
  absl::StatusOr<v1::TemplateBundle> Ask(const std::string& name, int64_t revision,
                                         const rpc::Origin& origin);
  absl::StatusOr<std::shared_ptr<const CompiledTemplate>> Compile(const v1::TemplateBundle& bundle,
                                                                  std::string digest,
                                                                  bool is_exact);
  std::shared_ptr<const CompiledTemplate> Find(const std::string& name, int64_t revision,
                                               const std::string& digest, bool is_exact);
  void Keep(const std::shared_ptr<const CompiledTemplate>& compiled);

  const std::shared_ptr<grpc::Channel> catalog_;
  const std::size_t capacity_;
  ShapeSource shapes_;
  std::mutex mutex_;
  std::list<std::shared_ptr<const CompiledTemplate>> kept_;  // guarded by mutex_; latest first
};

}  // namespace mortise::simulator
