// Downloads from the simulator, which keeps the files of all evaluators.
#include "common/evaluation/design_file.h"

#include <grpcpp/client_context.h>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/rpc/chunk_calls.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::evaluation {
namespace {

constexpr std::int64_t kMaximumSize = std::int64_t{256} << 20;  // as DesignFields.size
constexpr int kTries = 2;                                       // of a file that came damaged

}  // namespace

absl::StatusOr<std::string> FetchDesignFile(const std::shared_ptr<grpc::Channel>& channel,
                                            const std::string& sha256, const rpc::Origin& origin,
                                            const rpc::RetryOptions& retry) {
  const auto stub = v1::SimulatorService::NewStub(channel);
  v1::DownloadBlobRequest request;
  request.set_sha256(sha256);
  const absl::Status too_large = TooLarge("the file of shape and fields", "256 MiB");
  std::string bytes;
  for (int i = 0; i < kTries; ++i) {
    const absl::Status fetched =
        rpc::CallWithRetry(origin, retry, [&](grpc::ClientContext* context) {
          const std::stop_callback stopping(retry.stop, [context] { context->TryCancel(); });
          const auto reader = stub->DownloadBlob(context, request);
          auto received = rpc::ReceiveChunks(*context, *reader, kMaximumSize, too_large);
          if (received.ok()) bytes = *std::move(received);
          return rpc::ToGrpc(received.status());
        });
    MORTISE_RETURN_IF_ERROR(fetched);
    if (Sha256Hex(bytes) == sha256) return bytes;
  }
  return WithDetail(absl::DataLossError(absl::StrCat("the file of shape and fields ", sha256,
                                                     " came with another digest")),
                    {"FILE_DAMAGED", sha256});
}

}  // namespace mortise::evaluation
