// The methods about indexes.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/retrieval.h"

namespace mortise::retrieval::methods {

// That a request has been checked, outside of its transaction.
struct Checked {};

// As CheckRequest and CheckTemplates; the latter is left to the operation where the catalog cannot
// be asked now.
absl::StatusOr<Checked> PrepareBuild(const Retrieval& retrieval, const rpc::Call& call,
                                     const v1::BuildIndexRequest& request);

absl::StatusOr<v1::Operation> BuildIndex(const Retrieval& retrieval, const rpc::Call& call,
                                         const v1::BuildIndexRequest& request, Checked&,
                                         store::Transaction& transaction);

// NOT_FOUND for an index that was never built; FAILED_PRECONDITION, INDEX_IN_USE, while it is being
// built.
absl::StatusOr<Checked> PrepareDeletion(const Retrieval& retrieval, const rpc::Call& call,
                                        const v1::DeleteIndexRequest& request);

absl::StatusOr<v1::DeleteIndexResponse> DeleteIndex(const rpc::Call& call,
                                                    const v1::DeleteIndexRequest& request, Checked&,
                                                    store::Transaction& transaction);

// NOT_FOUND for an index that was never built.
absl::StatusOr<v1::ShapeIndex> GetIndex(const Retrieval& retrieval, const rpc::Call& call,
                                        const v1::GetIndexRequest& request);

// NOT_FOUND likewise; INVALID_ARGUMENT naming "page_size" or "page_token".
absl::StatusOr<v1::ListIndexFamiliesResponse> ListIndexFamilies(
    const Retrieval& retrieval, const rpc::Call& call, const v1::ListIndexFamiliesRequest& request);

absl::StatusOr<v1::ListIndexesResponse> ListIndexes(const Retrieval& retrieval,
                                                    const rpc::Call& call,
                                                    const v1::ListIndexesRequest& request);

}  // namespace mortise::retrieval::methods
