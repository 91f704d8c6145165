#include "services/retrieval/service/index_methods.h"

#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "services/retrieval/service/index_operation.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval::methods {

absl::StatusOr<v1::Operation> BuildIndex(const Retrieval& retrieval, const rpc::Call& call,
                                         const v1::BuildIndexRequest& request,
                                         store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(CheckRequest(request));
  MORTISE_ASSIGN_OR_RETURN(const jobs::Operation operation,
                           retrieval.environment.operations->Start(
                               transaction, rpc::OperationOf(call, jobs::kIndexOperation, "indexes",
                                                             request.SerializeAsString())));
  return rpc::ToProto(operation);
}

absl::StatusOr<v1::ShapeIndex> GetIndex(const Retrieval& retrieval, const rpc::Call&,
                                        const v1::GetIndexRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index,
                           kIndexes.Get(*retrieval.environment.store, request.name()));
  resources::PageRoom room(resources::kLargestPageSize);
  int shown = 0;
  while (shown < index.families_size() && room.Take(index.families(shown).ByteSizeLong())) ++shown;
  index.mutable_families()->DeleteSubrange(shown, index.families_size() - shown);
  return index;
}

absl::StatusOr<v1::ListIndexFamiliesResponse> ListIndexFamilies(
    const Retrieval& retrieval, const rpc::Call&, const v1::ListIndexFamiliesRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(request));
  MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index,
                           kIndexes.Get(*retrieval.environment.store, request.name()));
  resources::PageRoom room(query.size);
  resources::Page<v1::ShapeIndex::Family> page;
  std::string last;
  for (v1::ShapeIndex::Family& family : *index.mutable_families()) {
    if (family.template_() <= query.after) continue;
    if (request.only_faults() && family.fault().empty()) continue;
    if (!room.Take(family.ByteSizeLong())) {
      page.next_page_token = last;
      break;
    }
    last = family.template_();
    page.entries.push_back(std::move(family));
  }
  return resources::ToResponse(std::move(page), &v1::ListIndexFamiliesResponse::mutable_families);
}

absl::StatusOr<v1::ListIndexesResponse> ListIndexes(const Retrieval& retrieval, const rpc::Call&,
                                                    const v1::ListIndexesRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(request));
  MORTISE_ASSIGN_OR_RETURN(
      resources::Page<v1::ShapeIndex> page,
      resources::ReadFrom<resources::Page<v1::ShapeIndex>>(
          *retrieval.environment.store, [&](store::ReadTransaction& transaction) {
            return resources::ReadPage<v1::ShapeIndex>(transaction, {.kind = kIndexes.kind}, query);
          }));
  for (v1::ShapeIndex& index : page.entries) index.clear_families();
  return resources::ToResponse(std::move(page), &v1::ListIndexesResponse::mutable_indexes);
}

}  // namespace mortise::retrieval::methods
