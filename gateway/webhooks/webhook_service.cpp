// WebhookService: the adapter of the methods in webhook_methods.h.
#include "common/rpc/method_overrides.h"
#include "gateway/admission/budget.h"
#include "gateway/forwarding/hosted_services.h"
#include "gateway/webhooks/webhook_methods.h"
#include "mortise/v1/gateway.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr int kLookups = 2;  // of hosts at a time
constexpr int kTests = 2;    // of receivers at a time

class WebhookAdapter final : public v1::WebhookService::CallbackService {
  using Contract = v1::WebhookService::CallbackService;

 public:
  explicit WebhookAdapter(const HostedEnvironment& environment)
      : webhooks_{.environment = environment, .lookups = &lookups_, .tests = &tests_},
        endpoint_(environment.dispatcher, "mortise.v1.WebhookService") {}

  MORTISE_PREPARED_MUTATION(CreateWebhook, rpc::With(webhooks_, methods::DraftWebhook),
                            rpc::With(webhooks_, methods::CreateWebhook))
  MORTISE_QUERY(GetWebhook, rpc::With(webhooks_, methods::GetWebhook))
  MORTISE_QUERY(ListWebhooks, rpc::With(webhooks_, methods::ListWebhooks))
  MORTISE_PREPARED_MUTATION(UpdateWebhook, rpc::With(webhooks_, methods::CheckUpdate),
                            rpc::With(webhooks_, methods::UpdateWebhook))
  MORTISE_QUERY(TestWebhook, rpc::With(webhooks_, methods::TestWebhook))
  MORTISE_MUTATION(RotateWebhookSecret, rpc::With(webhooks_, methods::RotateWebhookSecret))
  MORTISE_MUTATION(DeleteWebhook, rpc::With(webhooks_, methods::DeleteWebhook))
  MORTISE_MUTATION(ReplayWebhook, rpc::With(webhooks_, methods::ReplayWebhook))
  MORTISE_QUERY(ListDeadLetters, rpc::With(webhooks_, methods::ListDeadLetters))

 private:
  Budget lookups_{kLookups, kLookups};
  Budget tests_{kTests, kTests};
  const Webhooks webhooks_;
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeWebhookService(const HostedEnvironment& environment) {
  return std::make_shared<WebhookAdapter>(environment);
}

}  // namespace mortise::gateway
