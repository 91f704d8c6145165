// Answers the methods of ParetoService.
#include "services/pareto/service/pareto_service.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/host/chunk_stream.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/record_page.h"
#include "common/rpc/channel.h"
#include "common/rpc/handler.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "services/pareto/front/front_files.h"
#include "services/pareto/service/discovery_operation.h"
#include "services/pareto/service/discovery_problem.h"
#include "services/pareto/service/discovery_start.h"
#include "services/pareto/service/front_cache.h"
#include "services/pareto/service/front_queries.h"
#include "services/pareto/service/remote_evaluator.h"

namespace mortise::pareto {
namespace {

constexpr std::size_t kCachedFronts = 32;

// A front as lists show it: without its points.
absl::StatusOr<std::optional<v1::Front>> Summary(const store::Record& record) {
  MORTISE_ASSIGN_OR_RETURN(v1::Front front, resources::ParseRecord<v1::Front>(kFrontKind, record));
  front.clear_points();
  return front;
}

class ParetoAdapter : public v1::ParetoService::CallbackService {
 public:
  explicit ParetoAdapter(rpc::ServiceEnvironment& environment)
      : environment_(environment), endpoint_(environment.dispatcher, "mortise.v1.ParetoService") {}

  // The evaluator is asked before the transaction: it settles the revision and knows the names.
  grpc::ServerUnaryReactor* DiscoverFront(grpc::CallbackServerContext* context,
                                          const v1::DiscoverFrontRequest* request,
                                          v1::Operation* response) override {
    return endpoint_.PreparedMutation(
        "DiscoverFront", context, request, response,
        [this](const rpc::Call& call, const v1::DiscoverFrontRequest& asked) {
          return Settle(call, asked.specification());
        },
        [this](const rpc::Call& call, const v1::DiscoverFrontRequest& asked,
               SettledDiscovery& settled,
               store::Transaction& transaction) -> absl::StatusOr<v1::Operation> {
          MORTISE_ASSIGN_OR_RETURN(
              const jobs::Operation started,
              environment_.operations->Start(
                  transaction,
                  rpc::OperationOf(call, jobs::kDiscoveryOperation, settled.specification.subject(),
                                   asked, settled.specification.SerializeAsString())));
          if (!settled.start.points().empty()) {
            const std::string id = started.name.substr(started.name.rfind('/') + 1);
            MORTISE_RETURN_IF_ERROR(
                transaction.Put(kStartKind, id, settled.start.SerializeAsString()).status());
          }
          return rpc::ToProto(started);
        });
  }

  grpc::ServerUnaryReactor* GetFront(grpc::CallbackServerContext* context,
                                     const v1::GetFrontRequest* request,
                                     v1::Front* response) override {
    return endpoint_.Query("GetFront", context, request, response,
                           [this](const rpc::Call&, const v1::GetFrontRequest& asked) {
                             return FindFront(asked.name());
                           });
  }

  grpc::ServerUnaryReactor* ListFronts(grpc::CallbackServerContext* context,
                                       const v1::ListFrontsRequest* request,
                                       v1::ListFrontsResponse* response) override {
    return endpoint_.Query(
        "ListFronts", context, request, response,
        [this](const rpc::Call&, const v1::ListFrontsRequest& asked) { return List(asked); });
  }

  grpc::ServerUnaryReactor* PickPoint(grpc::CallbackServerContext* context,
                                      const v1::PickPointRequest* request,
                                      v1::PickPointResponse* response) override {
    return endpoint_.Query(
        "PickPoint", context, request, response,
        [this](const rpc::Call&,
               const v1::PickPointRequest& asked) -> absl::StatusOr<v1::PickPointResponse> {
          MORTISE_ASSIGN_OR_RETURN(const auto front, OpenedFront(asked.name()));
          return Pick(*front, asked);
        });
  }

  grpc::ServerUnaryReactor* RestrictFront(grpc::CallbackServerContext* context,
                                          const v1::RestrictFrontRequest* request,
                                          v1::RestrictFrontResponse* response) override {
    return endpoint_.Query(
        "RestrictFront", context, request, response,
        [this](const rpc::Call&,
               const v1::RestrictFrontRequest& asked) -> absl::StatusOr<v1::RestrictFrontResponse> {
          MORTISE_ASSIGN_OR_RETURN(const auto front, OpenedFront(asked.name()));
          return Restrict(*front, asked);
        });
  }

  grpc::ServerWriteReactor<v1::Chunk>* ExportFront(grpc::CallbackServerContext* context,
                                                   const v1::ExportFrontRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "ExportFront", context, request,
        [this](const rpc::Call&, const v1::ExportFrontRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) -> absl::Status {
          return Export(asked, writer);
        });
  }

 private:
  struct SettledDiscovery {
    v1::DiscoverySpecification specification;
    v1::Front start;  // see SettleStart; without points if it starts from nothing
  };

  absl::StatusOr<SettledDiscovery> Settle(const rpc::Call& call,
                                          const v1::DiscoverySpecification& specification) {
    MORTISE_RETURN_IF_ERROR(CheckSpecification(specification));
    MORTISE_ASSIGN_OR_RETURN(auto channel, environment_.peers->Channel(kEvaluatorPeer));
    auto described = DescribeDesignSpace(channel, specification, rpc::ForwardedFrom(call), {});
    if (!described.ok()) {
      const bool named = absl::IsInvalidArgument(described.status());
      return named ? UnderField("specification", described.status()) : described.status();
    }
    MORTISE_ASSIGN_OR_RETURN(const DiscoveryProblem problem,
                             MakeProblem(specification, **described));
    SettledDiscovery settled{specification, {}};
    settled.specification.set_revision((*described)->revision());
    std::vector<v1::Front> fronts;
    for (int i = 0; i < specification.start_from_size(); ++i) {
      MORTISE_ASSIGN_OR_RETURN(v1::Front front,
                               FindFront(specification.start_from(i),
                                         absl::StrCat("specification.start_from[", i, "]")));
      fronts.push_back(std::move(front));
    }
    MORTISE_ASSIGN_OR_RETURN(settled.start, SettleStart(settled.specification, problem, fronts));
    return settled;
  }

  absl::StatusOr<v1::Front> FindFront(const std::string& name, const std::string& field = "name") {
    MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, "fronts", field));
    v1::Front front;
    MORTISE_RETURN_IF_ERROR(
        environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
          const auto record = transaction.Get(kFrontKind, id);
          if (absl::IsNotFound(record.status())) return ResourceNotFound(name);
          MORTISE_RETURN_IF_ERROR(record.status());
          MORTISE_ASSIGN_OR_RETURN(front, resources::ParseRecord<v1::Front>(kFrontKind, *record));
          return absl::OkStatus();
        }));
    return front;
  }

  absl::StatusOr<std::shared_ptr<const OpenFront>> OpenedFront(const std::string& name) {
    return cache_.Find(name, [&] { return FindFront(name); });
  }

  absl::StatusOr<v1::ListFrontsResponse> List(const v1::ListFrontsRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
    resources::Page<v1::Front> page;
    MORTISE_RETURN_IF_ERROR(
        environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(
              page, resources::ReadPage<v1::Front>(
                        transaction, {.kind = kFrontKind, .newest_first = true}, query,
                        [](const store::Record& record) { return Summary(record); }));
          return absl::OkStatus();
        }));
    v1::ListFrontsResponse response;
    for (v1::Front& front : page.entries) *response.add_fronts() = std::move(front);
    response.set_next_page_token(page.next_page_token);
    return response;
  }

  absl::Status Export(const v1::ExportFrontRequest& asked,
                      const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
    MORTISE_ASSIGN_OR_RETURN(const v1::Front front, FindFront(asked.name()));
    const std::string stem =
        absl::StrCat("front-", asked.name().substr(asked.name().find('/') + 1));
    switch (asked.format()) {
      case v1::ExportFrontRequest::CSV:
        rpc::StreamBytes(FrontAsCsv(front), {absl::StrCat(stem, ".csv"), "text/csv"}, writer);
        return absl::OkStatus();
      case v1::ExportFrontRequest::JSON: {
        MORTISE_ASSIGN_OR_RETURN(std::string json, FrontAsJson(front));
        rpc::StreamBytes(std::move(json), {absl::StrCat(stem, ".json"), "application/json"},
                         writer);
        return absl::OkStatus();
      }
      case v1::ExportFrontRequest::SVG: {
        MORTISE_ASSIGN_OR_RETURN(std::string svg, FrontAsSvg(front));
        rpc::StreamBytes(std::move(svg), {absl::StrCat(stem, ".svg"), "image/svg+xml"}, writer);
        return absl::OkStatus();
      }
      case v1::ExportFrontRequest::PNG: {
        MORTISE_ASSIGN_OR_RETURN(std::string png, FrontAsPng(front));
        rpc::StreamBytes(std::move(png), {absl::StrCat(stem, ".png"), "image/png"}, writer);
        return absl::OkStatus();
      }
      default:
        return InvalidField("format", "must be CSV, JSON, SVG or PNG");
    }
  }

  rpc::ServiceEnvironment& environment_;
  rpc::Endpoint endpoint_;
  FrontCache cache_{kCachedFronts};
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment) {
  environment.operations->Register(jobs::kDiscoveryOperation,
                                   [&environment](jobs::OperationContext& context) {
                                     return RunDiscoveryOperation(environment, context);
                                   });
  return std::vector<std::shared_ptr<grpc::Service>>{std::make_shared<ParetoAdapter>(environment)};
}

}  // namespace mortise::pareto
