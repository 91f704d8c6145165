// Events and operations of a real service through the gateway.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <nlohmann/json.hpp>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/gateway/events_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

TEST_F(EventsTest, FollowsEventsOverGrpc) {
  Tell("item.created", "items/a");
  Tell("design.created", "designs/b");
  grpc::ClientContext context;
  v1::FollowEventsRequest request;
  request.add_type_prefixes("item.");
  const auto reader = v1::EventService::NewStub(channel_)->FollowEvents(&context, request);
  v1::Event event;
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_EQ(event.subject(), "items/a");
  EXPECT_EQ(event.number(), 1);
  Tell("item.deleted", "items/a");
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_EQ(event.type(), "item.deleted");
  EXPECT_EQ(event.number(), 3);
  context.TryCancel();
  reader->Finish();
}

TEST_F(EventsTest, StreamsEventsOverHttpAndResumes) {
  Tell("item.created", "items/a");
  Tell("item.created", "items/b");
  {
    HttpStream stream(gateway_->addresses().http, "/events?streams=catalog&after=0");
    const std::string text = stream.ReadUntil("items/b");
    EXPECT_THAT(text, HasSubstr("text/event-stream"));
    EXPECT_THAT(text, HasSubstr("id: catalog:1\nevent: item.created\ndata: {"));
    Tell("item.created", "items/c");
    EXPECT_THAT(stream.ReadUntil("items/c"), HasSubstr("id: catalog:3"));
  }
  HttpStream resumed(gateway_->addresses().http, "/events", {{"Last-Event-ID", "catalog:2"}});
  const std::string text = resumed.ReadUntil("items/c");
  EXPECT_THAT(text, HasSubstr("id: catalog:3"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("items/b")));
}

TEST_F(EventsTest, RefusesMalformedEventRequests) {
  const std::string& http = gateway_->addresses().http;
  EXPECT_EQ(Http(http, "GET", "/events?after=x").status, 400);
  EXPECT_EQ(Http(http, "GET", "/events?colour=red").status, 400);
  const HttpAnswer nobody = Http(http, "GET", "/events?streams=nobody");
  EXPECT_EQ(nobody.status, 404);
  EXPECT_EQ(Json::parse(nobody.body)["message"], "there is no stream 'nobody'");
  EXPECT_EQ(Http(http, "GET", "/events", {{"Last-Event-ID", "catalog"}}).status, 400);
}

TEST_F(EventsTest, RefusesToFollowWhatNobodyWouldAskFor) {
  const auto follow = [&](const v1::FollowEventsRequest& request) {
    grpc::ClientContext context;
    const auto reader = v1::EventService::NewStub(channel_)->FollowEvents(&context, request);
    v1::Event event;
    EXPECT_FALSE(reader->Read(&event));
    return rpc::FromGrpc(reader->Finish());
  };
  v1::FollowEventsRequest request;
  request.add_type_prefixes("item.");
  request.add_type_prefixes(std::string(257, 'x'));
  const absl::Status long_prefix = follow(request);
  EXPECT_EQ(long_prefix.code(), absl::StatusCode::kInvalidArgument) << long_prefix;
  EXPECT_EQ(DetailOf(long_prefix).field, "type_prefixes[1]");
  // A request is kept for as long as its stream: those that are large are not.
  request.clear_type_prefixes();
  for (int i = 0; i < 10000; ++i) request.add_streams("catalog");
  const absl::Status large = follow(request);
  EXPECT_EQ(large.code(), absl::StatusCode::kResourceExhausted) << large;
  EXPECT_EQ(DetailOf(large).reason, "TOO_LARGE");
}

TEST_F(EventsTest, WatchesOperations) {
  const std::string name = StartOperation();
  HttpStream stream(gateway_->addresses().http, "/" + name + "/watch");
  EXPECT_THAT(stream.ReadUntil("half"), HasSubstr("event: operation\ndata: {"));
  FinishOperations();
  EXPECT_THAT(stream.ReadUntil("SUCCEEDED"), HasSubstr("SUCCEEDED"));
  EXPECT_EQ(Http(gateway_->addresses().http, "GET", "/operations/catalog/none/watch").status, 404);

  grpc::ClientContext context;
  v1::ListOperationsResponse list;
  const grpc::Status status = v1::OperationService::NewStub(channel_)->ListOperations(
      &context, v1::ListOperationsRequest(), &list);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(list.operations_size(), 1);
  EXPECT_EQ(list.operations(0).name(), name);
}

TEST_F(EventsTest, EventsSurviveARestartOfTheService) {
  HttpStream stream(gateway_->addresses().http, "/events?after=0");
  Tell("item.created", "items/a");
  stream.ReadUntil("items/a");
  service_.reset();
  StartService();
  Tell("item.created", "items/b");
  EXPECT_THAT(stream.ReadUntil("items/b"), HasSubstr("id: catalog:2"));
}

}  // namespace
}  // namespace mortise::gateway
