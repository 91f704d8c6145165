#include "services/retrieval/service/index_operation.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/base/violation_lists.h"
#include "common/host/operation_codec.h"
#include "services/retrieval/catalog/template_names.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/service/cover_plan.h"
#include "services/retrieval/service/index_assembly.h"
#include "services/retrieval/service/index_covering.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

constexpr std::chrono::milliseconds kLookForTurn{200};

// What the request says, or what the index has, or a default.
absl::StatusOr<double> DeltaOf(const v1::BuildIndexRequest& request, const Descriptor& descriptor,
                               store::Store& store) {
  if (request.delta() > 0) return request.delta();
  const absl::StatusOr<v1::ShapeIndex> present =
      kIndexes.Get(store, absl::StrCat(kIndexes.names, "/", descriptor.properties().name));
  if (present.ok()) return present->delta();
  if (absl::IsNotFound(present.status())) return DefaultDelta(descriptor);
  return present.status();
}

// The descriptors that a request names, or all, each once.
std::vector<v1::ShapeDescriptor> DescriptorsOf(const v1::BuildIndexRequest& request) {
  std::set<v1::ShapeDescriptor> chosen;
  for (const int each : request.shape_descriptors()) {
    const auto descriptor = static_cast<v1::ShapeDescriptor>(each);
    chosen.insert(descriptor == v1::SHAPE_DESCRIPTOR_UNSPECIFIED ? v1::D2 : descriptor);
  }
  if (chosen.empty()) return AllShapeDescriptors();
  return {chosen.begin(), chosen.end()};
}

absl::StatusOr<std::vector<IndexTarget>> TargetsOf(const v1::BuildIndexRequest& request,
                                                   store::Store& store) {
  std::vector<IndexTarget> targets;
  for (const v1::ShapeDescriptor kind : DescriptorsOf(request)) {
    IndexTarget target{.kind = kind, .id = IndexIdOf(kind), .descriptor = nullptr};
    MORTISE_ASSIGN_OR_RETURN(target.descriptor, MakeDescriptor(target.id));
    MORTISE_ASSIGN_OR_RETURN(target.delta, DeltaOf(request, *target.descriptor, store));
    if (!request.templates().empty()) {
      target.wanted.emplace(request.templates().begin(), request.templates().end());
    }
    targets.push_back(std::move(target));
  }
  return targets;
}

}  // namespace

absl::Status CheckRequest(const v1::BuildIndexRequest& request) {
  absl::Status status;
  const int descriptors = static_cast<int>(AllShapeDescriptors().size());
  if (request.shape_descriptors_size() > descriptors) {
    status = InvalidField("shape_descriptors", absl::StrCat("has more than ", descriptors));
  }
  status = CombineViolations(status, CheckTemplateNames(request.templates()));
  if (request.refresh() && !request.templates().empty()) {
    status = CombineViolations(status, InvalidField("refresh", "is not possible with templates"));
  }
  if (request.delta() == 0) return status;
  if (!(request.delta() > 0)) {
    status =
        CombineViolations(status, InvalidField("delta", "must be above 0, or 0 for a default"));
  }
  if (DescriptorsOf(request).size() == 1) return status;
  return CombineViolations(status, InvalidField("delta", "is of one descriptor: name it"));
}

absl::StatusOr<std::string> RunIndexOperation(const IndexBuilding& building,
                                              jobs::OperationContext& context) {
  v1::BuildIndexRequest request;
  if (!request.ParseFromString(context.request())) {
    return StorageFailed(context.name(), "the request is not readable");
  }
  std::unique_lock turn(building.turn, std::defer_lock);
  while (!turn.try_lock_for(kLookForTurn)) {
    if (context.Cancelled()) return absl::CancelledError("the build was cancelled");
  }
  rpc::RetryOptions retry;
  retry.patience = kCatalogTimeout;  // the catalog may be starting again
  retry.stop = context.stop_token();
  context.ReportProgress({.total = 0, .message = "asking for the templates"});
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<v1::Template> templates,
      building.templates.List({},
                              rpc::OwnOrigin(building.environment.signer, rpc::Role::kViewer,
                                             CurrentTraceId(), kCatalogTimeout),
                              retry));
  for (const std::string& name : request.templates()) {
    const bool is_there =
        std::any_of(templates.begin(), templates.end(),
                    [&](const v1::Template& each) { return each.name() == name; });
    if (!is_there) return ResourceNotFound(name);
  }
  MORTISE_ASSIGN_OR_RETURN(std::vector<IndexTarget> targets,
                           TargetsOf(request, *building.environment.store));
  CoverPlan plan(building, context, targets, request.anew());
  MORTISE_RETURN_IF_ERROR(plan.Prepare(templates, request.refresh()));
  MORTISE_RETURN_IF_ERROR(IndexCovering(building, context, plan).Run(templates));
  v1::BuildIndexResponse response;
  for (const IndexTarget& target : targets) {
    MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index,
                             PutIndexTogether(building, context, target, templates));
    index.clear_families();
    *response.add_indexes() = std::move(index);
  }
  return rpc::PackResult(response);
}

}  // namespace mortise::retrieval
