#include "cli/client/generic_call.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/support/byte_buffer.h>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

std::string ToString(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  std::string bytes;
  if (!buffer.Dump(&slices).ok()) return bytes;
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

absl::Status CallOnce(const GatewayClient& client, grpc::ClientContext& context,
                      const std::string& method, const std::string& request,
                      const std::function<bool(const std::string& response)>& take) {
  grpc::GenericStub stub(client.channel());
  grpc::CompletionQueue queue;
  // One thing is under way at a time, so the next completion is always the one just asked for.
  const auto completed = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  const auto call = stub.PrepareCall(&context, method, &queue);
  call->StartCall(nullptr);
  if (completed()) {
    const grpc::Slice slice(request);
    call->WriteLast(grpc::ByteBuffer(&slice, 1), grpc::WriteOptions(), nullptr);
    completed();
    while (true) {
      grpc::ByteBuffer response;
      call->Read(&response, nullptr);
      if (!completed()) break;
      if (!take(ToString(response))) {
        context.TryCancel();
        grpc::Status ignored;
        call->Finish(&ignored, nullptr);
        completed();
        return absl::OkStatus();
      }
    }
  }
  grpc::Status status;
  call->Finish(&status, nullptr);
  completed();
  return rpc::FromGrpc(status);
}

}  // namespace

absl::Status CallGeneric(const GatewayClient& client, const std::string& method,
                         const std::string& request, double seconds,
                         const std::function<bool(const std::string& response)>& take) {
  bool answered = false;
  absl::Status status;
  const absl::Status last = client.Call(
      [&](grpc::ClientContext& context) {
        status = CallOnce(client, context, method, request, [&](const std::string& response) {
          answered = true;
          return take(response);
        });
        // A stream that has begun is not begun again.
        return answered ? absl::OkStatus() : status;
      },
      seconds);
  return answered ? status : last;
}

absl::Status CallMethod(const GatewayClient& client,
                        const google::protobuf::MethodDescriptor& method,
                        const google::protobuf::Message& request,
                        google::protobuf::Message& response) {
  constexpr double kSeconds = 60;
  const std::string path = absl::StrCat("/", method.service()->full_name(), "/", method.name());
  bool is_read = true;
  MORTISE_RETURN_IF_ERROR(CallGeneric(
      client, path, request.SerializeAsString(), kSeconds,
      [&](const std::string& bytes) { return is_read = response.ParseFromString(bytes); }));
  return is_read ? absl::OkStatus() : absl::InternalError(absl::StrCat("no answer of ", path));
}

}  // namespace mortise::cli
