// ListOperations and ListAuditRecords over all services, newest first.
#include <google/protobuf/util/time_util.h>
#include <grpcpp/channel.h>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/resources/resource_filter.h"
#include "common/rpc/channel.h"
#include "common/rpc/method_overrides.h"
#include "common/rpc/mutation_log.h"
#include "gateway/forwarding/hosted_services.h"
#include "gateway/forwarding/merged_list.h"
#include "gateway/forwarding/upstreams.h"
#include "mortise/v1/audit.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr char kGateway[] = "gateway";

int64_t Micros(const google::protobuf::Timestamp& time) {
  return google::protobuf::util::TimeUtil::TimestampToMicroseconds(time);
}

template <class Message>
std::size_t SizeOf(const Message& message) {
  return message.ByteSizeLong();
}

// A service that restarts is waited for; one that stays away makes the list fail, because a list
// with a part missing would look complete.
rpc::RetryOptions Patience() {
  rpc::RetryOptions options;
  options.patience = absl::Seconds(3);
  return options;
}

// The services to ask: all, or the one a request names. NOT_FOUND for one there is not.
absl::StatusOr<std::vector<std::string>> Sources(const Upstreams& upstreams,
                                                 const std::string& wanted, bool with_gateway) {
  std::vector<std::string> sources;
  for (const auto& [name, address] : upstreams.addresses()) {
    if (name == kGateway && !with_gateway) continue;
    if (wanted.empty() || wanted == name) sources.push_back(name);
  }
  if (sources.empty() && !wanted.empty() && wanted != kGateway) {
    return WithDetail(absl::NotFoundError(absl::StrCat("there is no service '", wanted, "'")),
                      {"RESOURCE_NOT_FOUND", wanted});
  }
  return sources;
}

absl::StatusOr<ListPage<v1::Operation>> FetchOperations(const Upstreams& upstreams,
                                                        const rpc::Call& call,
                                                        const std::string& service,
                                                        const v1::ListOperationsRequest& request) {
  v1::OperationService::Stub stub(upstreams.Channel(service));
  MORTISE_ASSIGN_OR_RETURN(
      v1::ListOperationsResponse page,
      (rpc::CallUnary<v1::OperationService::Stub, v1::ListOperationsRequest,
                      v1::ListOperationsResponse>(stub, &v1::OperationService::Stub::ListOperations,
                                                  request, rpc::ForwardedFrom(call), Patience())));
  return ListPage<v1::Operation>{{page.operations().begin(), page.operations().end()},
                                 page.next_page_token()};
}

// Each service is asked with the filters of the caller, and for the page that is needed of it.
absl::StatusOr<v1::ListOperationsResponse> ListOperations(const HostedEnvironment& environment,
                                                          const rpc::Call& call,
                                                          const v1::ListOperationsRequest& asked) {
  // Also where no service is left to ask.
  MORTISE_RETURN_IF_ERROR(resources::ResourceFilter::Of(asked).status());
  MORTISE_ASSIGN_OR_RETURN(const std::vector<std::string> sources,
                           Sources(*environment.upstreams, asked.service(), false));
  const auto fetch = [&](const std::string& service, int page_size, const std::string& token) {
    v1::ListOperationsRequest request = asked;
    request.set_page_size(page_size);
    request.set_page_token(token);
    return FetchOperations(*environment.upstreams, call, service, request);
  };
  const auto newer = [](const v1::Operation& a, const v1::Operation& b) {
    return Micros(a.create_time()) > Micros(b.create_time());
  };
  MORTISE_ASSIGN_OR_RETURN(
      ListPage<v1::Operation> merged,
      MergeLists<v1::Operation>(
          sources, asked.page_size(), asked.page_token(), fetch, newer,
          [](const v1::Operation& operation) { return operation.name(); }, SizeOf<v1::Operation>));
  v1::ListOperationsResponse response;
  for (v1::Operation& item : merged.items) *response.add_operations() = std::move(item);
  response.set_next_page_token(merged.next_page_token);
  return response;
}

class MergedOperations final : public v1::OperationService::CallbackService {
  using Contract = v1::OperationService::CallbackService;

 public:
  explicit MergedOperations(const HostedEnvironment& environment)
      : environment_(environment),
        endpoint_(environment.dispatcher, "mortise.v1.OperationService") {}

  MORTISE_QUERY(ListOperations, rpc::With(environment_, gateway::ListOperations))

 private:
  const HostedEnvironment environment_;
  rpc::Endpoint endpoint_;
};

using AuditPage = ListPage<v1::AuditRecord>;

absl::StatusOr<AuditPage> FetchAudit(const HostedEnvironment& environment, const rpc::Call& call,
                                     const std::string& service, int page_size,
                                     const std::string& token) {
  if (service == kGateway) {
    MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query,
                             resources::ReadPageQuery(page_size, token));
    MORTISE_ASSIGN_OR_RETURN(auto own, rpc::ListAudit(*environment.store, query));
    return AuditPage{std::move(own.entries), std::move(own.next_page_token)};
  }
  v1::AuditService::Stub stub(environment.upstreams->Channel(service));
  v1::ListAuditRecordsRequest request;
  request.set_page_size(page_size);
  request.set_page_token(token);
  MORTISE_ASSIGN_OR_RETURN(v1::ListAuditRecordsResponse page,
                           (rpc::CallUnary<v1::AuditService::Stub, v1::ListAuditRecordsRequest,
                                           v1::ListAuditRecordsResponse>(
                               stub, &v1::AuditService::Stub::ListAuditRecords, request,
                               rpc::ForwardedFrom(call), Patience())));
  return AuditPage{{page.records().begin(), page.records().end()}, page.next_page_token()};
}

absl::StatusOr<v1::ListAuditRecordsResponse> ListAuditRecords(
    const HostedEnvironment& environment, const rpc::Call& call,
    const v1::ListAuditRecordsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<std::string> sources,
                           Sources(*environment.upstreams, asked.service(), true));
  const auto fetch = [&](const std::string& service, int page_size, const std::string& token) {
    return FetchAudit(environment, call, service, page_size, token);
  };
  const auto newer = [](const v1::AuditRecord& a, const v1::AuditRecord& b) {
    return Micros(a.time()) > Micros(b.time());
  };
  MORTISE_ASSIGN_OR_RETURN(
      AuditPage merged,
      MergeLists<v1::AuditRecord>(
          sources, asked.page_size(), asked.page_token(), fetch, newer,
          [](const v1::AuditRecord& record) { return Sha256Hex(record.SerializeAsString()); },
          SizeOf<v1::AuditRecord>));
  v1::ListAuditRecordsResponse response;
  for (v1::AuditRecord& item : merged.items) *response.add_records() = std::move(item);
  response.set_next_page_token(merged.next_page_token);
  return response;
}

class MergedAudit final : public v1::AuditService::CallbackService {
  using Contract = v1::AuditService::CallbackService;

 public:
  explicit MergedAudit(const HostedEnvironment& environment)
      : environment_(environment), endpoint_(environment.dispatcher, "mortise.v1.AuditService") {}

  MORTISE_QUERY(ListAuditRecords, rpc::With(environment_, gateway::ListAuditRecords))

 private:
  const HostedEnvironment environment_;
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeMergedOperationService(const HostedEnvironment& environment) {
  return std::make_shared<MergedOperations>(environment);
}

std::shared_ptr<grpc::Service> MakeMergedAuditService(const HostedEnvironment& environment) {
  return std::make_shared<MergedAudit>(environment);
}

}  // namespace mortise::gateway
