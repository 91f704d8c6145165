#include "services/pareto/service/discovery_methods.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/evaluation/described_design_space.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/channel.h"
#include "mortise/v1/evaluator.pb.h"
#include "services/pareto/service/discovery_operation.h"
#include "services/pareto/service/discovery_problem.h"
#include "services/pareto/service/discovery_start.h"
#include "services/pareto/service/front_records.h"
#include "services/pareto/service/remote_evaluator.h"

namespace mortise::pareto::methods {
namespace {

// The fronts that a specification starts from, in its order.
absl::StatusOr<std::vector<v1::Front>> EarlierFronts(
    store::Store& store, const v1::DiscoverySpecification& specification) {
  std::vector<v1::Front> fronts;
  for (int i = 0; i < specification.start_from_size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(v1::Front front,
                             kFronts.Get(store, specification.start_from(i),
                                         absl::StrCat("specification.start_from[", i, "]")));
    fronts.push_back(std::move(front));
  }
  return fronts;
}

}  // namespace

absl::StatusOr<SettledDiscovery> SettleDiscovery(const Pareto& pareto, const rpc::Call& call,
                                                 const v1::DiscoverFrontRequest& asked) {
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(CheckSpecification(asked.specification()), resources::ValidateTags(asked)));
  MORTISE_ASSIGN_OR_RETURN(const auto channel, pareto.peers->Channel(kEvaluatorPeer));
  const auto described = evaluation::DescribeDesignSpace(
      channel, DescriptionRequest(asked.specification()), rpc::ForwardedFrom(call), {});
  if (!described.ok()) {
    const bool named = absl::IsInvalidArgument(described.status());
    return named ? UnderField("specification", described.status()) : described.status();
  }
  MORTISE_ASSIGN_OR_RETURN(const DiscoveryProblem problem,
                           MakeProblem(asked.specification(), **described));
  SettledDiscovery settled{asked, {}};
  v1::DiscoverySpecification& specification = *settled.request.mutable_specification();
  specification.set_revision((*described)->revision());
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Front> fronts,
                           EarlierFronts(*pareto.store, specification));
  MORTISE_ASSIGN_OR_RETURN(settled.start, SettleStart(specification, problem, fronts));
  return settled;
}

absl::StatusOr<v1::Operation> DiscoverFront(const Pareto& pareto, const rpc::Call& call,
                                            const v1::DiscoverFrontRequest&,
                                            SettledDiscovery& settled,
                                            store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(
      const operations::Operation started,
      pareto.operations->Start(
          transaction,
          rpc::OperationOf(call, operations::kDiscoveryOperation,
                           settled.request.specification().subject(), settled.request)));
  if (!settled.start.points().empty()) {
    const std::string id = started.name.substr(started.name.rfind('/') + 1);
    MORTISE_RETURN_IF_ERROR(
        transaction.Put(kStartKind, id, settled.start.SerializeAsString()).status());
  }
  return rpc::ToProto(started);
}

}  // namespace mortise::pareto::methods
