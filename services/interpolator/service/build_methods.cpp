#include "services/interpolator/service/build_methods.h"

#include <memory>
#include <utility>

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
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/map_records.h"
#include "services/interpolator/service/map_specification.h"
#include "services/interpolator/service/plan_request.h"
#include "services/interpolator/service/verify_operation.h"

namespace mortise::interpolator::methods {

absl::StatusOr<v1::BuildMapRequest> SettleMap(const Interpolator& interpolator,
                                              const rpc::Call& call,
                                              const v1::BuildMapRequest& asked) {
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(CheckSpecification(asked.specification()), resources::ValidateTags(asked)));
  MORTISE_ASSIGN_OR_RETURN(const auto channel, interpolator.peers->Channel(kEvaluatorPeer));
  const auto described = evaluation::DescribeDesignSpace(
      channel, DescriptionOf(asked.specification()), rpc::ForwardedFrom(call), {});
  if (!described.ok()) {
    const bool is_named = absl::IsInvalidArgument(described.status());
    return is_named ? UnderField("specification", described.status()) : described.status();
  }
  MORTISE_RETURN_IF_ERROR(MakePlan(asked.specification(), **described).status());
  v1::BuildMapRequest settled = asked;
  settled.mutable_specification()->set_revision((*described)->revision());
  return settled;
}

absl::StatusOr<v1::Operation> BuildMap(const Interpolator& interpolator, const rpc::Call& call,
                                       const v1::BuildMapRequest&, v1::BuildMapRequest& settled,
                                       store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(
      const operations::Operation started,
      interpolator.operations->Start(transaction,
                                     rpc::OperationOf(call, operations::kMapOperation,
                                                      settled.specification().subject(), settled)));
  return rpc::ToProto(started);
}

absl::StatusOr<v1::Operation> VerifyMap(const Interpolator& interpolator, const rpc::Call& call,
                                        const v1::VerifyMapRequest& asked,
                                        store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, kMaps.Get(transaction, asked.name()));
  if (!asked.points().empty()) {
    MORTISE_RETURN_IF_ERROR(ReadPoints(map, asked.points(), kMaxVerified).status());
    if (asked.random_points() != 0) {
      return InvalidField("random_points", "must be left out where points are given");
    }
  }
  if (asked.random_points() < 0 || asked.random_points() > kMaxVerified) {
    return InvalidField("random_points", absl::StrCat("must lie between 1 and ", kMaxVerified));
  }
  MORTISE_ASSIGN_OR_RETURN(
      const operations::Operation started,
      interpolator.operations->Start(
          transaction, rpc::OperationOf(call, operations::kVerificationOperation, asked.name(),
                                        asked.SerializeAsString())));
  return rpc::ToProto(started);
}

}  // namespace mortise::interpolator::methods
