#include "services/retrieval/service/index_methods.h"

#include <compare>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/rpc/channel.h"
#include "services/retrieval/service/index_builds.h"
#include "services/retrieval/service/index_operation.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval::methods {
namespace {

// Where a family stands in its index: by name of its template, the whole before its groups. A group
// may have any characters, which a page token may not.
struct FamilyPosition {
  std::string template_name;  // templates/{id}
  std::string group;          // in hexadecimal digits, which keep its order

  auto operator<=>(const FamilyPosition&) const = default;
};

FamilyPosition PositionOf(const v1::ShapeIndex::Family& family) {
  return {family.template_(), absl::BytesToHexString(family.group())};
}

std::string TokenOf(const FamilyPosition& position) {
  return absl::StrCat(position.template_name, position.group.empty() ? "" : "/", position.group);
}

FamilyPosition PositionOfToken(const std::string& token) {
  const std::size_t end = token.find('/', token.find('/') + 1);
  if (end == std::string::npos) return {token, ""};
  return {token.substr(0, end), token.substr(end + 1)};
}

// Why an index cannot be searched; empty where it can.
std::string FaultOf(const Retrieval& retrieval, const v1::ShapeIndex& index) {
  const absl::Status loaded = retrieval.indexes.Get(index.shape_descriptor()).status();
  return std::string(loaded.message());
}

}  // namespace

absl::StatusOr<Checked> PrepareBuild(const Retrieval& retrieval, const rpc::Call& call,
                                     const v1::BuildIndexRequest& request) {
  MORTISE_RETURN_IF_ERROR(CheckRequest(request));
  const auto templates = retrieval.templates.List({}, rpc::ForwardedFrom(call));
  if (!templates.ok()) return Checked();  // the operation has more patience, and checks again
  MORTISE_RETURN_IF_ERROR(CheckTemplates(request, *templates, *retrieval.environment.store));
  return Checked();
}

absl::StatusOr<v1::Operation> BuildIndex(const Retrieval& retrieval, const rpc::Call& call,
                                         const v1::BuildIndexRequest& request, Checked&,
                                         store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(
      const operations::Operation operation,
      retrieval.environment.operations->Start(
          transaction, rpc::OperationOf(call, operations::kIndexOperation, "indexes",
                                        request.SerializeAsString())));
  return rpc::ToProto(operation);
}

absl::StatusOr<Checked> PrepareDeletion(const Retrieval& retrieval, const rpc::Call&,
                                        const v1::DeleteIndexRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const v1::ShapeIndex index,
                           kIndexes.Get(*retrieval.environment.store, request.name()));
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<std::string> build,
      BuildUnderWay(*retrieval.environment.operations, index.shape_descriptor()));
  if (!build) return Checked();
  return PreconditionFailed(
      "INDEX_IN_USE",
      absl::StrCat(*build, " builds the index, and would make it again: cancel it first"),
      request.name());
}

absl::StatusOr<v1::DeleteIndexResponse> DeleteIndex(const rpc::Call&,
                                                    const v1::DeleteIndexRequest& request, Checked&,
                                                    store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(ForgetIndex(transaction, request.name(), CurrentTraceId()));
  return v1::DeleteIndexResponse();
}

absl::StatusOr<v1::ShapeIndex> GetIndex(const Retrieval& retrieval, const rpc::Call&,
                                        const v1::GetIndexRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index,
                           kIndexes.Get(*retrieval.environment.store, request.name()));
  index.set_fault(FaultOf(retrieval, index));
  resources::PageRoom room(resources::kMaxPageSize);
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
  const FamilyPosition after = PositionOfToken(query.after);
  FamilyPosition last;
  for (v1::ShapeIndex::Family& family : *index.mutable_families()) {
    if (PositionOf(family) <= after) continue;
    if (request.only_faults() && family.fault().empty()) continue;
    if (!room.Take(family.ByteSizeLong())) {
      page.next_page_token = TokenOf(last);
      break;
    }
    last = PositionOf(family);
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
  for (v1::ShapeIndex& index : page.entries) {
    index.clear_families();
    index.set_fault(FaultOf(retrieval, index));
  }
  return resources::ToResponse(std::move(page), &v1::ListIndexesResponse::mutable_indexes);
}

}  // namespace mortise::retrieval::methods
