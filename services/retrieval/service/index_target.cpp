#include "services/retrieval/service/index_target.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

absl::StatusOr<double> DeltaOf(const v1::BuildIndexRequest& request, const Descriptor& descriptor,
                               store::Store& store) {
  if (request.delta() > 0) return request.delta();
  const absl::StatusOr<v1::ShapeIndex> present =
      kIndexes.Get(store, absl::StrCat(kIndexes.names, "/", descriptor.properties().name));
  if (present.ok()) return present->delta();
  if (absl::IsNotFound(present.status())) return DefaultDelta(descriptor);
  return present.status();
}

}  // namespace

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

}  // namespace mortise::retrieval
