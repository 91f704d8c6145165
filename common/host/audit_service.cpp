#include "common/host/audit_service.h"

#include <utility>

#include "common/base/errors.h"
#include "common/resources/collection.h"
#include "common/resources/page_rule.h"
#include "common/rpc/method_overrides.h"
#include "common/rpc/mutation_log.h"
#include "mortise/v1/audit.grpc.pb.h"

namespace mortise::rpc {
namespace {

// Whose records are shown.
struct AuditedService {
  store::Store* store;
  std::string name;
};

absl::StatusOr<v1::ListAuditRecordsResponse> ListAuditRecords(
    const AuditedService& service, const Call&, const v1::ListAuditRecordsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
  if (!asked.service().empty() && asked.service() != service.name) {
    return v1::ListAuditRecordsResponse();
  }
  MORTISE_ASSIGN_OR_RETURN(auto page, ListAudit(*service.store, query));
  return resources::ToResponse(std::move(page), &v1::ListAuditRecordsResponse::mutable_records);
}

class AuditAdapter final : public v1::AuditService::CallbackService {
  using Contract = v1::AuditService::CallbackService;

 public:
  AuditAdapter(Dispatcher* dispatcher, AuditedService service)
      : service_(std::move(service)), endpoint_(dispatcher, "mortise.v1.AuditService") {}

  MORTISE_QUERY(ListAuditRecords, With(service_, rpc::ListAuditRecords))

 private:
  const AuditedService service_;
  Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeAuditService(Dispatcher* dispatcher, store::Store* store,
                                                const std::string& service) {
  return std::make_shared<AuditAdapter>(dispatcher, AuditedService{store, service});
}

}  // namespace mortise::rpc
