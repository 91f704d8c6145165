// External ids and labels of webhooks, of a gateway in front of a real service: listed by, changed,
// and kept while events are delivered. And the lists of operations, which take the same filter.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/gateway/events_fixture.h"
#include "tests/integration/gateway/holding_receiver.h"
#include "tests/support/status_assertions.h"

namespace mortise::gateway {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Stub = v1::WebhookService::Stub;

class WebhookTagsTest : public EventsTest {
 protected:
  template <class Service, class Request, class Response>
  absl::StatusOr<Response> Call(grpc::Status (Service::*method)(grpc::ClientContext*,
                                                                const Request&, Response*),
                                const Request& request) {
    Service stub(channel_);
    return rpc::CallUnary(stub, method, request, {});
  }

  v1::CreateWebhookRequest Request(const std::string& id, const std::string& project) {
    v1::CreateWebhookRequest request;
    request.set_request_id("create-" + id);
    request.set_url(receiver_.url());
    request.add_external_ids(id);
    (*request.mutable_labels())["project"] = project;
    return request;
  }

  v1::Webhook Create(const std::string& id, const std::string& project) {
    const auto webhook = Call(&Stub::CreateWebhook, Request(id, project));
    EXPECT_OK(webhook);
    return webhook.ok() ? *webhook : v1::Webhook();
  }

  std::vector<std::string> Names(const v1::ListWebhooksRequest& request) {
    std::vector<std::string> names;
    const auto page = Call(&Stub::ListWebhooks, request);
    EXPECT_OK(page);
    if (!page.ok()) return names;
    for (const v1::Webhook& webhook : page->webhooks()) {
      EXPECT_EQ(webhook.secret(), "");
      names.push_back(webhook.name());
    }
    return names;
  }

  static std::vector<std::string> FieldsAtFault(const absl::Status& status) {
    std::vector<std::string> fields;
    for (const FieldViolation& violation : AllViolationsOf(status)) {
      fields.push_back(violation.field);
    }
    return fields;
  }

  HoldingReceiver receiver_;
};

TEST_F(WebhookTagsTest, WebhooksAreFoundByTheirTags) {
  const v1::Webhook first = Create("ERP-1", "loft");
  const v1::Webhook second = Create("ERP-2", "loft");
  EXPECT_FALSE(first.secret().empty());
  EXPECT_FALSE(first.creator().empty());
  EXPECT_EQ(first.external_ids(0), "ERP-1");
  v1::ListWebhooksRequest request;
  EXPECT_THAT(Names(request), ElementsAre(first.name(), second.name())) << "by name";
  request.mutable_filter()->set_external_id("ERP-2");
  EXPECT_THAT(Names(request), ElementsAre(second.name()));
  request.Clear();
  (*request.mutable_filter()->mutable_labels())["project"] = "loft";
  request.mutable_filter()->set_creator(first.creator());
  EXPECT_EQ(Names(request).size(), 2u);
  (*request.mutable_filter()->mutable_labels())["project"] = "shed";
  EXPECT_THAT(Names(request), IsEmpty());
  request.Clear();
  *request.mutable_filter()->mutable_created_from() = second.create_time();
  EXPECT_THAT(Names(request), ElementsAre(second.name()));
}

TEST_F(WebhookTagsTest, TagsChangedDuringADeliveryStay) {
  const v1::Webhook webhook = Create("ERP-1", "loft");
  Tell("item.created", "items/a");
  receiver_.Take(1);  // its progress will be written when it is answered
  v1::UpdateWebhookRequest update;
  update.set_request_id("update-1");
  update.mutable_webhook()->set_name(webhook.name());
  update.mutable_webhook()->set_url("http://192.0.2.1/");
  (*update.mutable_webhook()->mutable_labels())["project"] = "shed";
  update.mutable_update_mask()->add_paths("labels");
  const auto updated = Call(&Stub::UpdateWebhook, update);
  ASSERT_OK(updated);
  EXPECT_EQ(updated->secret(), "");
  EXPECT_EQ(updated->url(), webhook.url()) << "nothing but tags";
  receiver_.Answer();
  v1::GetWebhookRequest get;
  get.set_name(webhook.name());
  v1::Webhook seen;
  const absl::Status moved = rpc::CallWithRetry({}, {}, [&](grpc::ClientContext* context) {
    const grpc::Status status = Stub(channel_).GetWebhook(context, get, &seen);
    if (!status.ok() || seen.cursors(0).number() == 1) return status;
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  });
  ASSERT_OK(moved);
  EXPECT_EQ(seen.labels().at("project"), "shed");
  EXPECT_EQ(seen.external_ids(0), "ERP-1");
  EXPECT_EQ(seen.creator(), webhook.creator());
  // What is signed with the secret goes on: the change has kept it.
  Tell("item.created", "items/b");
  receiver_.Take(1);
  receiver_.Answer();
}

TEST_F(WebhookTagsTest, AllThatIsWrongIsTold) {
  v1::CreateWebhookRequest create = Request("ERP-1", "loft");
  create.set_url("ftp://x/");
  create.add_streams("nobody");
  create.add_external_ids("ERP-1");
  (*create.mutable_labels())["-"] = "x";
  EXPECT_THAT(FieldsAtFault(Call(&Stub::CreateWebhook, create).status()),
              UnorderedElementsAre("url", "streams[0]", "external_ids[1]", "labels"));
  EXPECT_THAT(Names({}), IsEmpty());
  v1::ListWebhooksRequest list;
  list.set_page_size(-1);
  list.mutable_filter()->set_external_id("\n");
  EXPECT_THAT(FieldsAtFault(Call(&Stub::ListWebhooks, list).status()),
              UnorderedElementsAre("page_size", "filter.external_id"));
  v1::UpdateWebhookRequest update;
  update.set_request_id("update-1");
  update.mutable_webhook()->set_name("webhooks/none");
  EXPECT_TRUE(absl::IsNotFound(Call(&Stub::UpdateWebhook, update).status()));
  update.mutable_webhook()->add_external_ids("");
  update.mutable_update_mask()->add_paths("secret");
  EXPECT_THAT(FieldsAtFault(Call(&Stub::UpdateWebhook, update).status()),
              UnorderedElementsAre("update_mask", "webhook.external_ids[0]"));
}

TEST_F(WebhookTagsTest, OperationsOfAllServicesAreFoundByTheirTags) {
  std::vector<std::string> tagged;
  for (int i = 0; i < 5; ++i) {
    ASSERT_OK(service_->environment().store->Transact(
        [&](store::Transaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(
              const operations::Operation started,
              service_->environment().operations->Start(
                  transaction, {.kind = "catalog.wait",
                                .creator = "users/ada",
                                .tags = {.external_ids = {"ERP-1"},
                                         .labels = {{"parity", i % 2 == 0 ? "even" : "odd"}}}}));
          if (i % 2 == 0) tagged.insert(tagged.begin(), started.name);
          return absl::OkStatus();
        }));
  }
  using Operations = v1::OperationService::Stub;
  v1::ListOperationsRequest request;
  request.set_page_size(2);
  request.mutable_filter()->set_external_id("ERP-1");
  (*request.mutable_filter()->mutable_labels())["parity"] = "even";
  std::vector<std::string> listed;
  int pages = 0;
  do {
    const auto page = Call(&Operations::ListOperations, request);
    ASSERT_OK(page);
    for (const v1::Operation& operation : page->operations()) {
      EXPECT_EQ(operation.labels().at("parity"), "even");
      listed.push_back(operation.name());
    }
    request.set_page_token(page->next_page_token());
    ++pages;
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, tagged) << "newest first, none twice";
  EXPECT_EQ(pages, 2);
  // A page of one filter is none of another.
  request.set_page_size(1);
  request.set_page_token(Call(&Operations::ListOperations, request)->next_page_token());
  (*request.mutable_filter()->mutable_labels())["parity"] = "odd";
  EXPECT_THAT(FieldsAtFault(Call(&Operations::ListOperations, request).status()),
              ElementsAre("page_token"));
  request.clear_page_token();
  request.mutable_filter()->set_creator(std::string(201, 'x'));
  EXPECT_THAT(FieldsAtFault(Call(&Operations::ListOperations, request).status()),
              ElementsAre("filter.creator"));
  request.set_service("gateway");
  EXPECT_THAT(FieldsAtFault(Call(&Operations::ListOperations, request).status()),
              ElementsAre("filter.creator"))
      << "also where nobody is asked";
  FinishOperations();
}

}  // namespace
}  // namespace mortise::gateway
