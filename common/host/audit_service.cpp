#include "common/host/audit_service.h"

#include <utility>

#include "common/base/errors.h"
#include "common/resources/page_rule.h"
#include "common/rpc/handler.h"
#include "common/rpc/mutation_log.h"
#include "mortise/v1/audit.grpc.pb.h"

namespace mortise::rpc {
namespace {

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
    MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
    v1::ListAuditRecordsResponse response;
    if (!asked.service().empty() && asked.service() != service_) return response;
    MORTISE_ASSIGN_OR_RETURN(auto page, ListAudit(*store_, query));
    for (v1::AuditRecord& record : page.entries) *response.add_records() = std::move(record);
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
