// Fits the designs of matches to the query.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/channel.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/families/match_sheet.h"
#include "services/retrieval/index/primitive_index.h"
#include "services/retrieval/service/loaded_indexes.h"
#include "services/retrieval/service/query_shape.h"

namespace mortise::retrieval {

inline constexpr int kMaxFits = 20;  // matches of one search

// What fits begin with.
struct FitTask {
  const QueryShape& query;
  const std::vector<Eigen::VectorXd>& descriptors;  // of the query, at each turn
  const LoadedIndex& index;
  const std::vector<IndexMatch>& matches;
};

// Fits the family of each match, from its nearest primitives on, several families at a time, and
// tells of it in the match of the response, in their order. A fit that fails is told there, and the
// match stays. Together they take most of the time that the call has left, but leave some for the
// answer: each has an equal share of what there is when it begins, and one that has found nothing
// by then tells so as its fault, with what would help. Where all fitted designs are of quite
// another size than the query, whose unit is known, a note asks whether that is right. Returns the
// designs that were fitted, where they stand in the query's frame, without those that failed.
// CANCELLED once nobody waits for the answer; UNAVAILABLE where the catalog is.
absl::StatusOr<std::vector<FitEntry>> FitMatches(const FitTask& task, TemplateSource& templates,
                                                 const rpc::Origin& origin, const rpc::Call& call,
                                                 v1::SearchShapesResponse* response);

}  // namespace mortise::retrieval
