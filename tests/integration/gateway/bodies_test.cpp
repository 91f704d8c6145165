// Bodies of requests: who may send them, how much and how slowly, and what compressed ones become.
#include <gmock/gmock.h>
#include <google/protobuf/unknown_field_set.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/server_limits.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/gateway/gateway_fixture.h"
#include "tests/unit/common/rpc/self_signed.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kGetItem[] = "/mortise.v1.CatalogService/GetItem";

class BodiesTest : public GatewayTest {
 protected:
  void Start(GatewayOptions options) {
    StartGateway(options);
    token_ = signer_.Sign(
        {{"sub", "ada"}, {"roles", {"designer"}}, {"exp", absl::ToUnixSeconds(absl::Now()) + 600}});
  }

  // The head of a POST of `bytes` of JSON.
  std::string Head(std::size_t bytes, const std::string& token,
                   const std::string& more = "") const {
    return std::string("POST ") + kGetItem +
           " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" +
           (token.empty() ? "" : "Authorization: Bearer " + token + "\r\n") +
           "Content-Length: " + std::to_string(bytes) + "\r\n" + more + "\r\n";
  }

  std::unique_ptr<HttpStream> Send(const std::string& bytes) {
    return HttpStream::Send(gateway_->addresses().http, bytes);
  }

  const TokenSigner signer_{"EdDSA"};
  std::string token_;
};

TEST_F(BodiesTest, StrangersAreRefusedBeforeTheirBody) {
  Start(SecureOptions(signer_));
  const auto stream = Send(Head(4 << 20, ""));
  const std::string answer = stream->ReadUntil("}");
  EXPECT_THAT(answer, HasSubstr("401 Unauthorized"));
  EXPECT_THAT(answer, HasSubstr("Connection: close"));
  EXPECT_THAT(answer, HasSubstr("unauthenticated"));
  // Nor are they told to send it.
  const auto asking = Send(Head(4 << 20, "", "Expect: 100-continue\r\n"));
  EXPECT_THAT(asking->ReadUntil("}"), Not(HasSubstr("100 Continue")));
}

TEST_F(BodiesTest, WhatIsTooLargeIsRefusedBeforeItIsSent) {
  Start(SecureOptions(signer_));
  const auto stream = Send(Head(5 << 20, token_));
  EXPECT_THAT(stream->ReadUntil("}"), HasSubstr("resource_exhausted"));
}

TEST_F(BodiesTest, ARefusedRequestLeavesASmallBodysConnectionOpen) {
  Start(SecureOptions(signer_));
  const std::string body = R"({"name":"items/echo"})";
  const auto stream = Send(Head(body.size(), "") + body + Head(body.size(), token_) + body);
  const std::string answers = stream->ReadUntil("supplier");
  EXPECT_THAT(answers, HasSubstr("401 Unauthorized"));
  EXPECT_THAT(answers, HasSubstr("200 OK"));
}

TEST_F(BodiesTest, WhoAsksIsToldToGoOn) {
  Start(SecureOptions(signer_));
  const std::string body = R"({"name":"items/echo"})";
  const auto stream = Send(Head(body.size(), token_, "Expect: 100-continue\r\n"));
  EXPECT_THAT(stream->ReadUntil("\r\n\r\n"), HasSubstr("100 Continue"));
  stream->Write(body);
  EXPECT_THAT(stream->ReadUntil("supplier"), HasSubstr("200 OK"));
}

TEST_F(BodiesTest, SlowBodiesEndWithWords) {
  GatewayOptions options = SecureOptions(signer_);
  options.http_patience.body = std::chrono::milliseconds(50);
  Start(options);
  for (const char* more : {"", "Transfer-Encoding: chunked\r\n"}) {
    std::string head = Head(4 << 20, token_, more);
    if (*more != '\0') head.erase(head.find("Content-Length"), 25);
    const auto stream = Send(head);
    const std::string answer = stream->ReadUntil("}");
    EXPECT_THAT(answer, HasSubstr("408 Request Timeout")) << more;
    EXPECT_THAT(answer, HasSubstr("came too slowly")) << more;
  }
}

TEST_F(BodiesTest, SlowHeadsEnd) {
  GatewayOptions options = Options();
  options.http_patience.head = std::chrono::milliseconds(50);
  Start(options);
  const auto stream = Send("GET /version HTT");
  EXPECT_TRUE(stream->AwaitClose());
  EXPECT_EQ(stream->ReadUntil("never"), "") << "closed without a word";
}

TEST_F(BodiesTest, SlowHandshakesEnd) {
  const mortise::testing::SelfSigned own;
  GatewayOptions options = SecureOptions(signer_);
  options.security.certificate = folder_.path() / "own.pem";
  options.security.key = folder_.path() / "own.key";
  ASSERT_TRUE(WriteFile(options.security.certificate, own.certificate).ok());
  ASSERT_TRUE(WriteFile(options.security.key, own.key).ok());
  options.http_patience.head = std::chrono::milliseconds(50);
  Start(options);
  EXPECT_TRUE(Send("\x16")->AwaitClose()) << "the first byte of TLS, and nothing more";
}

TEST_F(BodiesTest, LargeBodiesShareABudget) {
  GatewayOptions options = SecureOptions(signer_);
  options.body_bytes = 16 << 20;  // of which one subject has a quarter
  Start(options);
  const auto waiting = Send(Head(4 << 20, token_, "Expect: 100-continue\r\n"));
  EXPECT_THAT(waiting->ReadUntil("\r\n\r\n"), HasSubstr("100 Continue"));
  const auto refused = Send(Head(4 << 20, token_));
  const std::string answer = refused->ReadUntil("}");
  EXPECT_THAT(answer, HasSubstr("429 Too Many Requests"));
  EXPECT_THAT(answer, HasSubstr("retry-after: 1"));
  // Calls of the usual size have room whatever large ones there are.
  const std::string body = R"({"name":"items/echo"})";
  EXPECT_THAT(Send(Head(body.size(), token_) + body)->ReadUntil("supplier"), HasSubstr("200 OK"));
  // What was taken is given back with the connection.
  waiting->Close();
  std::string later;
  for (int i = 0; i < 1000 && later.find("100 Continue") == std::string::npos; ++i) {
    later = Send(Head(4 << 20, token_, "Expect: 100-continue\r\n"))->ReadUntil("\r\n\r\n");
  }
  EXPECT_THAT(later, HasSubstr("100 Continue"));
}

TEST_F(BodiesTest, OtherCompressionsThanGzipAreRefused) {
  Start(Options());
  for (const char* encoding : {"deflate", "br", "gzip, gzip"}) {
    const HttpAnswer answer =
        Http(gateway_->addresses().http, "POST", kGetItem,
             {{"Content-Type", "application/json"}, {"Content-Encoding", encoding}}, "\x1f\x8b");
    EXPECT_EQ(answer.status, 501) << encoding;
  }
}

// What a client of gRPC sends that compresses.
class CompressedCallTest : public BodiesTest {
 protected:
  void SetUp() override { Start(Options()); }

  grpc::Status Call(grpc_compression_algorithm algorithm, const std::string& name, v1::Item* item) {
    grpc::ChannelArguments arguments;
    arguments.SetCompressionAlgorithm(algorithm);
    const auto channel = grpc::CreateCustomChannel(gateway_->addresses().grpc,
                                                   grpc::InsecureChannelCredentials(), arguments);
    grpc::ClientContext context;
    v1::GetItemRequest request;
    request.set_name(name);
    return v1::CatalogService::NewStub(channel)->GetItem(&context, request, item);
  }
};

TEST_F(CompressedCallTest, IsExpandedWithinTheLimit) {
  v1::Item item;
  const std::string name(3 << 20, 'x');
  const grpc::Status status = Call(GRPC_COMPRESS_GZIP, name, &item);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(item.name(), name);
}

TEST_F(CompressedCallTest, IsRefusedAsSoonAsItIsTooLarge) {
  v1::Item item;
  const grpc::Status status = Call(GRPC_COMPRESS_GZIP, std::string(64 << 20, 'x'), &item);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("expanded"));
}

TEST_F(CompressedCallTest, OtherAlgorithmsAreNotExpanded) {
  v1::Item item;
  const grpc::Status status = Call(GRPC_COMPRESS_DEFLATE, std::string(64 << 20, 'x'), &item);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNIMPLEMENTED) << status.error_message();
}

// A call of items/slow whose request is large once it is expanded, and which ends with this.
class LargeSlowCall {
 public:
  explicit LargeSlowCall(const std::shared_ptr<grpc::Channel>& channel)
      : thread_([this, channel] {
          v1::GetItemRequest request;
          request.set_name("items/slow");
          constexpr int kUnknownField = 1000;
          request.GetReflection()->MutableUnknownFields(&request)->AddLengthDelimited(
              kUnknownField, std::string(3 << 20, 'x'));
          v1::Item item;
          status_ = v1::CatalogService::NewStub(channel)->GetItem(&context_, request, &item);
        }) {}
  ~LargeSlowCall() { Cancel(); }

  void Cancel() {
    context_.TryCancel();
    if (thread_.joinable()) thread_.join();
  }

 private:
  grpc::ClientContext context_;
  grpc::Status status_;
  std::thread thread_;
};

TEST_F(CompressedCallTest, LargeOnesShareTheBudgetOfBodies) {
  GatewayOptions options = Options();
  options.body_bytes = 16 << 20;  // of which one subject has a quarter
  StartGateway(options);
  grpc::ChannelArguments arguments;
  arguments.SetCompressionAlgorithm(GRPC_COMPRESS_GZIP);
  LargeSlowCall first(grpc::CreateCustomChannel(gateway_->addresses().grpc,
                                                grpc::InsecureChannelCredentials(), arguments));
  ASSERT_TRUE(house_.WaitForSlow(1));
  v1::Item item;
  const std::string large(3 << 20, 'x');
  const absl::Status refused = rpc::FromGrpc(Call(GRPC_COMPRESS_GZIP, large, &item));
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted) << refused;
  EXPECT_EQ(DetailOf(refused).reason, "TOO_MANY_CALLS");
  EXPECT_THAT(std::string(refused.message()), HasSubstr("large"));
  const grpc::Status small = Call(GRPC_COMPRESS_GZIP, std::string(1000, 'x'), &item);
  EXPECT_TRUE(small.ok()) << small.error_message();
  // What a call took is given back with its end, a moment after its client has it.
  first.Cancel();
  grpc::Status later;
  for (int i = 0; i < 1000; ++i) {
    later = Call(GRPC_COMPRESS_GZIP, large, &item);
    if (later.ok()) break;
  }
  EXPECT_TRUE(later.ok()) << later.error_message();
}

TEST_F(CompressedCallTest, LargeMessagesThatCannotBeReadAreNamed) {
  const auto channel =
      grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  grpc::GenericStub stub(channel);
  for (const std::size_t bytes : {10, 100000}) {
    grpc::ClientContext context;
    const std::string text(bytes, '\xff');
    const grpc::Slice slice(text);
    const grpc::ByteBuffer request(&slice, 1);
    grpc::ByteBuffer response;
    std::promise<grpc::Status> promise;
    stub.UnaryCall(&context, kGetItem, {}, &request, &response,
                   [&](grpc::Status status) { promise.set_value(std::move(status)); });
    const grpc::Status status = promise.get_future().get();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("request"));
  }
}

TEST_F(CompressedCallTest, StreamsOfMessagesAreExpandedToo) {
  grpc::ChannelArguments arguments;
  arguments.SetCompressionAlgorithm(GRPC_COMPRESS_GZIP);
  const auto channel = grpc::CreateCustomChannel(gateway_->addresses().grpc,
                                                 grpc::InsecureChannelCredentials(), arguments);
  const auto simulator = v1::SimulatorService::NewStub(channel);
  for (const int bytes : {3 << 20, 64 << 20}) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto upload = simulator->UploadBlob(&context, &response);
    v1::Chunk chunk;
    chunk.set_data("first");
    upload->Write(chunk);
    chunk.set_data(std::string(bytes, 'x'));
    upload->Write(chunk);
    upload->WritesDone();
    const grpc::Status status = upload->Finish();
    if (bytes < rpc::kMaxMessageBytes) {
      EXPECT_TRUE(status.ok()) << status.error_message();
      EXPECT_EQ(response.sha256(), std::to_string(bytes + 5)) << "the bytes that came";
    } else {
      EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
      EXPECT_THAT(status.error_message(), HasSubstr("expanded"));
    }
  }
}

}  // namespace
}  // namespace mortise::gateway
