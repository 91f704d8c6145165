#include "services/retrieval/service/index_operation.h"

#include <memory>
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
#include "services/retrieval/service/index_builds.h"
#include "services/retrieval/service/index_covering.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

// Shapes that have nothing in common are no further apart, in natural scales of a descriptor.
constexpr double kMaxDelta = 2;

// Whether it is not so large that an index would tell nothing apart.
absl::Status CheckDelta(double delta, v1::ShapeDescriptor kind) {
  if (delta == 0) return absl::OkStatus();
  if (!(delta > 0)) return InvalidField("delta", "must be above 0, or 0 for a default");
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Descriptor> descriptor,
                           MakeDescriptor(IndexIdOf(kind)));
  const double largest = kMaxDelta * descriptor->properties().natural_scale;
  if (delta <= largest) return absl::OkStatus();
  return InvalidField("delta", absl::StrCat("must be at most ", largest, " of ", IndexIdOf(kind),
                                            ": all shapes are as near to each other as that"));
}

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
  const std::vector<v1::ShapeDescriptor> kinds = DescriptorsOf(request);
  status = CombineViolations(status, CheckDelta(request.delta(), kinds.front()));
  if (kinds.size() == 1) return status;
  return CombineViolations(status, InvalidField("delta", "is of one descriptor: name it"));
}

absl::Status CheckTemplates(const v1::BuildIndexRequest& request,
                            const std::vector<v1::Template>& templates, store::Store& store) {
  Revisions present;
  for (const v1::Template& each : templates) present[each.name()] = each.revision();
  for (const std::string& name : request.templates()) {
    if (!present.contains(name)) return ResourceNotFound(name);
  }
  if (!templates.empty()) return absl::OkStatus();
  for (const v1::ShapeDescriptor kind : DescriptorsOf(request)) {
    const std::string name = absl::StrCat(kIndexes.names, "/", IndexIdOf(kind));
    const absl::Status there = kIndexes.Get(store, name).status();
    if (!absl::IsNotFound(there)) continue;
    return PreconditionFailed(
        "NO_TEMPLATES",
        "the catalog has no templates yet, and an index would be of nothing: import some first, "
        "or start the house with a collection",
        name);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> RunIndexOperation(const IndexBuilding& building,
                                              operations::OperationContext& context) {
  v1::BuildIndexRequest request;
  if (!request.ParseFromString(context.request())) {
    return StorageFailed(context.name(), "the request is not readable");
  }
  MORTISE_ASSIGN_OR_RETURN(const std::unique_lock turn, building.turn.Take(context));
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
  store::Store& store = *building.environment.store;
  MORTISE_RETURN_IF_ERROR(CheckTemplates(request, templates, store));
  Revisions present;
  for (const v1::Template& each : templates) present[each.name()] = each.revision();
  MORTISE_ASSIGN_OR_RETURN(std::vector<IndexTarget> targets, TargetsOf(request, store));
  CoverPlan plan(building, context, targets, request.anew());
  MORTISE_RETURN_IF_ERROR(plan.Prepare(templates, request.refresh()));
  MORTISE_RETURN_IF_ERROR(IndexCovering(building, context, plan).Run(templates));
  v1::BuildIndexResponse response;
  for (const IndexTarget& target : targets) {
    const auto before = kIndexes.Get(store, absl::StrCat(kIndexes.names, "/", target.id));
    MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index,
                             PutIndexTogether(building, context, target, templates));
    std::string note = before.ok() ? WhoLeft(*before, index, present) : "";
    if (!note.empty()) response.add_notes(std::move(note));
    index.clear_families();
    *response.add_indexes() = std::move(index);
  }
  return rpc::PackResult(response);
}

}  // namespace mortise::retrieval
