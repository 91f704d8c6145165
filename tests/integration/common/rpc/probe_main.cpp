// A service of its own process, to be started, signalled and killed by process_test.
//
// Reads answer, and operations end, once the file they name exists; both say on standard output
// what they wait for. With END_AT_START in its environment it asks itself to end while it starts.
#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stop_token>
#include <thread>

#include "common/base/errors.h"
#include "common/host/operation_codec.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "tests/support/file_watch.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {
namespace {

void AwaitFile(const std::filesystem::path& path, const std::stop_token& stop) {
  const int stopped = ::eventfd(0, EFD_CLOEXEC);
  const std::stop_callback tell(stop, [stopped] { ::eventfd_write(stopped, 1); });
  std::printf("waiting for %s\n", path.c_str());
  std::fflush(stdout);
  WaitForFiles(
      path.parent_path(), [&] { return std::filesystem::exists(path); }, absl::InfiniteDuration(),
      stopped);
  ::close(stopped);
}

class Probe {
 public:
  absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
      rpc::ServiceEnvironment& environment) {
    operations::Operations* operations = environment.operations;
    handlers_.read = [](const rpc::Call& call,
                        const ReadRequest& request) -> absl::StatusOr<ReadResponse> {
      AwaitFile(request.name(), {});
      ReadResponse response;
      response.set_text(call.identity().subject);
      return response;
    };
    handlers_.begin = [operations](
                          const rpc::Call& call, const KeepRequest& request,
                          store::Transaction& transaction) -> absl::StatusOr<v1::Operation> {
      MORTISE_ASSIGN_OR_RETURN(
          const operations::Operation operation,
          operations->Start(transaction, {.kind = "probe.work",
                                          .request = request.value(),
                                          .subject = request.name(),
                                          .trace_id = call.identity().trace_id,
                                          .creator = call.identity().subject}));
      return rpc::ToProto(operation);
    };
    operations->Register("probe.work",
                         [](operations::OperationContext& context) -> absl::StatusOr<std::string> {
                           context.ReportProgress({.done = 1, .total = 2});
                           AwaitFile(context.request(), context.stop_token());
                           if (context.Cancelled()) return absl::CancelledError("asked to stop");
                           Kept kept;
                           kept.set_value("done");
                           return rpc::PackResult(kept);
                         });
    return std::vector<std::shared_ptr<grpc::Service>>{
        std::make_shared<ProbeAdapter>(environment.dispatcher, &handlers_)};
  }

 private:
  ProbeHandlers handlers_;
};

}  // namespace
}  // namespace mortise::testing

int main(int argc, char** argv) {
  // As libraries do that compute in parallel, before the service has a say in signals.
  std::thread([] {
    while (true) ::pause();
  }).detach();
  mortise::testing::Probe probe;
  return mortise::rpc::RunService(argc, argv, {.name = "probe", .title = "A service for tests."},
                                  [&](mortise::rpc::ServiceEnvironment& given) {
                                    if (std::getenv("END_AT_START") != nullptr) {
                                      ::kill(::getpid(), SIGTERM);
                                    }
                                    return probe.MakeServices(given);
                                  });
}
