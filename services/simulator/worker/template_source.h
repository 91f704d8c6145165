// Fetches template revisions from the catalog, compiles them, and keeps them by their content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/bundles/shape_source.h"
#include "common/expressions/metric_expressions.h"
#include "common/rpc/channel.h"
#include "common/templates/template.h"
#include "mortise/v1/catalog.pb.h"
#include "services/simulator/worker/design_motion.h"

namespace mortise::simulator {

// A template revision ready for evaluation.
struct EvaluatedTemplate {
  std::string name;  // templates/{id}
  int64_t revision = 0;
  std::string digest;  // of its content and of the items and materials it uses
  // Whether the shapes of parts that an analysis joins have their exact surfaces.
  bool is_exact = false;
  std::shared_ptr<const templates::Template> design_template;
  parametric::MetricDefinitions metrics = {};  // its own
  OfferedGradients gradients = {};
};

// Thread safe.
class TemplateSource {
 public:
  // `capacity` is the bytes of compiled revisions that are kept, the least recently used forgotten
  // first; the latest stays however large it is. Those who ask for the same revision at the same
  // time share one.
  explicit TemplateSource(std::shared_ptr<grpc::Channel> catalog,
                          std::size_t capacity = std::size_t{256} << 20);

  // Returns the revision, or the latest for 0. Asks the catalog; compiles only what it has not
  // seen. INVALID_ARGUMENT naming "subject" for a malformed name; NOT_FOUND; UNAVAILABLE.
  absl::StatusOr<std::shared_ptr<const EvaluatedTemplate>> Get(const std::string& name,
                                                               int64_t revision,
                                                               const rpc::Origin& origin);

  // Returns the same revision as a task names it, with the exact surfaces of parts that are joined;
  // without a question to the catalog if its content is known. FAILED_PRECONDITION,
  // TEMPLATE_CHANGED if items or materials have changed since; as bundles::ShapeSource::AddExact.
  absl::StatusOr<std::shared_ptr<const EvaluatedTemplate>> GetByDigest(const std::string& name,
                                                                       int64_t revision,
                                                                       const std::string& digest,
                                                                       const rpc::Origin& origin);

 private:
  using Kept = SingleFlightCache<std::shared_ptr<const EvaluatedTemplate>>;

  // `bundle` names the shapes that did not fit into its message.
  absl::StatusOr<Kept::Made> Compile(v1::TemplateBundle bundle, const std::string& digest,
                                     bool is_exact, const rpc::Origin& origin);

  const std::shared_ptr<grpc::Channel> catalog_;
  bundles::ShapeSource shapes_;
  Kept kept_;  // by name, revision and digest, with exact surfaces or without
};

}  // namespace mortise::simulator
