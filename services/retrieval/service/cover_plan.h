// Which covers a build lacks: those are queued, and the others brought up to what is said of their
// templates.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/operations/operations.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/index_operation.h"

namespace mortise::retrieval {

class CoverPlan {
 public:
  // All outlive it. `anew`: covers that there are do not count.
  CoverPlan(const IndexBuilding& building, operations::OperationContext& context,
            std::vector<IndexTarget>& targets, bool anew)
      : building_(building), context_(context), targets_(targets), anew_(anew) {}

  // Forgets the covers of templates that there are no more, and settles which the targets want: of
  // an index that is only refreshed those that it has; covers of an earlier version of the service
  // are brought up in any case.
  absl::Status Prepare(const std::vector<v1::Template>& templates, bool refresh);

  // Whether any target wants it.
  bool IsAskedFor(const v1::Template& head) const;

  // Queues what is missing of a template and of the groups of its assembly, once for all targets;
  // the keys of the tasks. Safe on several threads. Fails only where the whole build must: what is
  // wrong with the template is in its covers.
  absl::StatusOr<std::set<std::string>> Plan(const v1::Template& head);

 private:
  using Targets = std::vector<const IndexTarget*>;

  absl::StatusOr<std::set<std::string>> ForgetOthers(const std::set<std::string>& names,
                                                     const IndexTarget& target);
  absl::StatusOr<bool> PlanGroup(const v1::Template& head, const std::string& group,
                                 const Targets& targets, std::set<std::string>* keys);
  absl::StatusOr<bool> BringUp(const IndexTarget& target, const v1::ShapeIndex::Family& family,
                               const std::string& digest);
  absl::Status PutFault(const IndexTarget& target, v1::ShapeIndex::Family family,
                        const std::string& digest, const absl::Status& fault);
  absl::Status ForgetOtherGroups(const IndexTarget& target, const std::string& name,
                                 const std::set<std::string>& groups);
  rpc::Origin Origin() const;

  const IndexBuilding& building_;
  operations::OperationContext& context_;
  std::vector<IndexTarget>& targets_;
  const bool anew_;
};

}  // namespace mortise::retrieval
