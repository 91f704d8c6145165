// What the gRPC door answers without a token, health and reflection: truly, and not without end.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/support/sync_stream.h>

#include <future>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "gateway/forwarding/wire.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;

constexpr char kCheck[] = "/grpc.health.v1.Health/Check";
constexpr char kWatch[] = "/grpc.health.v1.Health/Watch";
constexpr char kReflect[] = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

// As they are on the wire: a status of health, and reflection's question for all services.
const std::string kServing("\x08\x01", 2);
const std::string kNotServing("\x08\x02", 2);
const std::string kServiceUnknown("\x08\x03", 2);
const std::string kListServices("\x3a\x00", 2);

// A call of any method, by the bytes of its messages.
class RawCall {
 public:
  RawCall(grpc::Channel& channel, const char* path, const std::string& authorization = "") {
    if (!authorization.empty()) context_.AddMetadata("authorization", authorization);
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    const grpc::internal::RpcMethod method(path, grpc::internal::RpcMethod::BIDI_STREAMING);
    stream_.reset(
        grpc::internal::ClientReaderWriterFactory<grpc::ByteBuffer, grpc::ByteBuffer>::Create(
            &channel, method, &context_));
  }

  void Send(const std::string& message) { stream_->Write(ToByteBuffer(message)); }

  // The next message; "ended" after the last.
  std::string Read() {
    grpc::ByteBuffer message;
    return stream_->Read(&message) ? ToString(message) : "ended";
  }

  absl::Status Finish() { return rpc::FromGrpc(stream_->Finish()); }

  void Cancel() { context_.TryCancel(); }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> stream_;
};

class AnybodyTest : public GatewayTest {
 protected:
  void Start(const GatewayOptions& options) {
    StartGateway(options);
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  }

  // One question and the first answer, or the reason of the refusal.
  std::string Ask(const char* path, const std::string& request,
                  const std::string& authorization = "") {
    RawCall call(*channel_, path, authorization);
    call.Send(request);
    std::string answer = call.Read();
    if (answer == "ended") return DetailOf(call.Finish()).reason;
    call.Cancel();
    return answer;
  }

  const TokenSigner signer_{"EdDSA"};
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(AnybodyTest, HealthIsChecked) {
  Start(SecureOptions(signer_));
  EXPECT_EQ(Ask(kCheck, ""), kServing);
  EXPECT_EQ(Ask(kCheck, std::string("\x0a\x00", 2)), kServing) << "the name that it has by itself";
  RawCall unknown(*channel_, kCheck);
  unknown.Send(
      "\x0a\x03"
      "abc");
  EXPECT_EQ(unknown.Read(), "ended");
  EXPECT_EQ(unknown.Finish().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Ask(kWatch,
                "\x0a\x03"
                "abc"),
            kServiceUnknown);
}

TEST_F(AnybodyTest, HealthIsWatchedToItsEnd) {
  Start(SecureOptions(signer_));
  RawCall watch(*channel_, kWatch);
  watch.Send("");
  EXPECT_EQ(watch.Read(), kServing);
  const auto stopped = std::async(std::launch::async, [this] { gateway_.reset(); });
  EXPECT_EQ(watch.Read(), kNotServing);
  EXPECT_EQ(watch.Read(), "ended");
  EXPECT_EQ(watch.Finish().code(), absl::StatusCode::kUnavailable);
}

TEST_F(AnybodyTest, StrangersHaveSoManyStreamsTogether) {
  GatewayOptions options = SecureOptions(signer_);
  options.open_calls.streams.of_subject = 2;
  Start(options);
  RawCall watch(*channel_, kWatch);
  watch.Send("");
  EXPECT_EQ(watch.Read(), kServing);
  RawCall reflection(*channel_, kReflect);
  reflection.Send(kListServices);
  EXPECT_THAT(reflection.Read(), HasSubstr("mortise.v1.CatalogService"));
  EXPECT_EQ(Ask(kWatch, ""), "TOO_MANY_STREAMS");
  EXPECT_EQ(Ask(kReflect, kListServices), "TOO_MANY_STREAMS");
  EXPECT_EQ(Ask(kReflect, kListServices, "Bearer nonsense"), "TOO_MANY_STREAMS");
  EXPECT_EQ(Ask(kCheck, ""), kServing) << "which is no stream";
  // Who shows a token has its own.
  const std::string token = signer_.Sign(
      {{"sub", "ada"}, {"roles", {"viewer"}}, {"exp", absl::ToUnixSeconds(absl::Now()) + 600}});
  EXPECT_THAT(Ask(kReflect, kListServices, "Bearer " + token),
              HasSubstr("mortise.v1.CatalogService"));
  // What ends makes room.
  watch.Cancel();
  std::string answer;
  for (int i = 0; i < 1000 && answer != kServing; ++i) answer = Ask(kWatch, "");
  EXPECT_EQ(answer, kServing);
}

TEST_F(AnybodyTest, ChecksWithoutAQuestionAreCounted) {
  GatewayOptions options = SecureOptions(signer_);
  options.open_calls.calls.of_subject = 1;
  Start(options);
  RawCall mute(*channel_, kCheck);
  std::string answer;
  for (int i = 0; i < 1000 && answer != "TOO_MANY_CALLS"; ++i) answer = Ask(kCheck, "");
  EXPECT_EQ(answer, "TOO_MANY_CALLS");
  mute.Cancel();
}

TEST_F(AnybodyTest, AStreamOfReflectionHasItsTime) {
  GatewayOptions options = SecureOptions(signer_);
  options.reflection_time = std::chrono::milliseconds(50);
  Start(options);
  RawCall mute(*channel_, kReflect);
  EXPECT_EQ(mute.Read(), "ended");
  EXPECT_EQ(mute.Finish().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace mortise::gateway
