#include "cli/files/metric_evaluation.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/evaluation/parameter_number.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"

namespace mortise::cli {
namespace {

constexpr double kPatience = 3600;  // s: a mesh as fine as is asked for takes its time

absl::StatusOr<v1::DesignPoint> PointOf(const v1::DesignSpace& space,
                                        const std::vector<v1::ParameterValue>& parameters) {
  v1::DesignPoint point;
  for (const auto& parameter : space.parameters()) point.add_parameters(parameter.default_value());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    int index = 0;
    while (index < space.parameters_size() &&
           space.parameters(index).name() != parameters[i].name()) {
      ++index;
    }
    if (index == space.parameters_size()) {
      return InvalidField(
          absl::StrCat("parameters[", i, "]"),
          absl::StrCat(space.subject(), " has no parameter '", parameters[i].name(), "'"));
    }
    MORTISE_ASSIGN_OR_RETURN(const double number,
                             evaluation::NumberOf(parameters[i], space.parameters(index).choices(),
                                                  absl::StrCat("parameters[", i, "]")));
    point.set_parameters(index, number);
  }
  return point;
}

}  // namespace

absl::StatusOr<v1::DesignSpace> DescribeDesignSpace(const v1::DescribeDesignSpaceRequest& request,
                                                    const GatewayClient& client) {
  const auto stub = v1::EvaluatorService::NewStub(client.channel());
  v1::DesignSpace space;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->DescribeDesignSpace(&context, request, &space));
  }));
  return space;
}

absl::StatusOr<EvaluatedMetrics> EvaluateMetrics(const std::string& subject,
                                                 const std::vector<v1::ParameterValue>& parameters,
                                                 const v1::EvaluateBatchRequest& asked,
                                                 const GatewayClient& client) {
  v1::DescribeDesignSpaceRequest describe;
  describe.set_subject(subject);
  describe.set_revision(asked.revision());
  MORTISE_ASSIGN_OR_RETURN(v1::DesignSpace space, DescribeDesignSpace(describe, client));
  v1::EvaluateBatchRequest request = asked;
  request.set_subject(space.subject());
  request.set_revision(space.revision());
  MORTISE_ASSIGN_OR_RETURN(*request.add_points(), PointOf(space, parameters));
  const auto stub = v1::EvaluatorService::NewStub(client.channel());
  v1::EvaluationResult result;
  MORTISE_RETURN_IF_ERROR(client.Call(
      [&](grpc::ClientContext& context) {
        const auto reader = stub->EvaluateBatch(&context, request);
        const bool has_come = reader->Read(&result);
        const absl::Status status = rpc::FromGrpc(reader->Finish());
        if (status.ok() && !has_come) return absl::DataLossError("no result came");
        return status;
      },
      kPatience));
  if (result.has_error()) return rpc::FromProto(result.error());
  return EvaluatedMetrics{std::move(space), std::move(result)};
}

}  // namespace mortise::cli
