// The operation behind BuildIndex: covers what has not been covered (index_covering.h), and puts
// the covers of all templates together (index_assembly.h).
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::retrieval {

class BuildTurn;
class CoverQueue;

// Fails with INVALID_ARGUMENT naming each field at fault.
absl::Status CheckRequest(const v1::BuildIndexRequest& request);

// An index that is being built.
struct IndexTarget {
  v1::ShapeDescriptor kind = v1::D2;
  std::string id;
  std::shared_ptr<const Descriptor> descriptor;
  double delta = 0;
  // Templates that are covered; all without.
  std::optional<std::set<std::string>> wanted = {};

  bool Wants(const std::string& template_name) const {
    return !wanted || wanted->contains(template_name);
  }
};

// Whether there is what a request asks for: NOT_FOUND for a template that is not among those there
// are; FAILED_PRECONDITION, NO_TEMPLATES, where there is none, and an index that is not there yet
// would be made of nothing.
absl::Status CheckTemplates(const v1::BuildIndexRequest& request,
                            const std::vector<v1::Template>& templates, store::Store& store);

// How long the catalog is waited for.
inline constexpr absl::Duration kCatalogTimeout = absl::Minutes(2);

// What it stands on; all outlive it.
struct IndexBuilding {
  rpc::ServiceEnvironment& environment;
  TemplateSource& templates;
  store::BlobFolder* blobs;
  CoverQueue& covers;
  int threads;  // of the service's own that cover families; 0 leaves all to workers
  BuildTurn& turn;
};

// Runs it: the packed v1::BuildIndexResponse. Families are covered on threads of the service's own
// and by workers elsewhere, each by itself, so that the index is the same on any number. A template
// that cannot be covered is in the index with its fault, and is tried again by the next build.
// Cancelled, it keeps the covers that are done, and the indexes stay as they were.
// FAILED_PRECONDITION, NO_TEMPLATES, where there is nothing to make an index of.
absl::StatusOr<std::string> RunIndexOperation(const IndexBuilding& building,
                                              operations::OperationContext& context);

}  // namespace mortise::retrieval
