// Sees to it that all covers of a build are there: plans them, works on them on threads of the
// service's own, and waits for those that other workers have.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/operations/operations.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/cover_plan.h"
#include "services/retrieval/service/index_operation.h"

namespace mortise::retrieval {

class IndexCovering {
 public:
  // All outlive it.
  IndexCovering(const IndexBuilding& building, operations::OperationContext& context,
                CoverPlan& plan)
      : building_(building), context_(context), plan_(plan) {}

  // Returns when all covers of the templates that are asked for are there, each as it is or with
  // its fault, and tells meanwhile of how many templates they are. CANCELLED when the operation is
  // to stop: tasks are cancelled then where somebody cancelled it, and left to their workers where
  // only this run of it ends.
  absl::Status Run(const std::vector<v1::Template>& templates);

 private:
  absl::Status Cover(const std::vector<v1::Template>& asked);
  absl::Status PlanAll(const std::vector<v1::Template>& asked);
  absl::Status AwaitAll(std::int64_t total);
  void WorkHere(int number, const std::stop_token& stop);
  void WorkOn(const v1::CoverTask& task, const std::stop_token& stop);
  bool IsGivenUp() const;
  std::int64_t CountDone();

  const IndexBuilding& building_;
  operations::OperationContext& context_;
  CoverPlan& plan_;
  std::mutex mutex_;
  // By template, which of its tasks may not have ended; guarded by mutex_.
  std::map<std::string, std::set<std::string>> waiting_;
};

}  // namespace mortise::retrieval
