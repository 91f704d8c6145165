#include "common/rpc/audit_service.h"

#include <utility>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/handler.h"
#include "common/rpc/mutation_log.h"
#include "mortise/v1/audit.grpc.pb.h"

namespace mortise::rpc {
namespace {

constexpr int kDefaultPage = 100;
constexpr int kLargestPage = 1000;

class AuditAdapter : public v1::AuditService::CallbackService {
 public:
  AuditAdapter(Dispatcher* dispatcher, store::Store* store, std::string service)
      : store_(store),
        service_(std::move(service)),
        endpoint_(dispatcher, "mortise.v1.AuditService") {}

  grpc::ServerUnaryReactor* ListAuditRecords(grpc::CallbackServerContext* context,
                                             const v1::ListAuditRecordsRequest* request,
                                             v1::ListAuditRecordsResponse* response) override {
    return endpoint_.Query(
        "ListAuditRecords", context, request, response,
        [this](const Call&, const v1::ListAuditRecordsRequest& asked) { return List(asked); });
  }

 private:
  absl::StatusOr<v1::ListAuditRecordsResponse> List(const v1::ListAuditRecordsRequest& asked) {
    if (asked.page_size() < 0 || asked.page_size() > kLargestPage) {
      return InvalidField("page_size", "must be 0 to 1000");
    }
    if (!asked.page_token().empty() && !IsResourceId(asked.page_token())) {
      return InvalidField("page_token", "is not one that this method gave");
    }
    v1::ListAuditRecordsResponse response;
    if (!asked.service().empty() && asked.service() != service_) return response;
    MORTISE_ASSIGN_OR_RETURN(
        AuditPage page,
        ListAudit(*store_, asked.page_size() == 0 ? kDefaultPage : asked.page_size(),
                  asked.page_token()));
    for (v1::AuditRecord& record : page.records) *response.add_records() = std::move(record);
    response.set_next_page_token(page.next_page_token);
    return response;
  }

  store::Store* const store_;
  const std::string service_;
  Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeAuditService(Dispatcher* dispatcher, store::Store* store,
                                                const std::string& service) {
  return std::make_shared<AuditAdapter>(dispatcher, store, service);
}

}  // namespace mortise::rpc
