// What the wrapper costs: unary calls a second over loopback, with identity, checks and metrics.
#include <benchmark/benchmark.h>
#include <grpcpp/grpcpp.h>
#include <prometheus/registry.h>

#include "common/base/logging.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/identity.h"
#include "common/rpc/message_check.h"
#include "common/rpc/server_host.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {
namespace {

// One server for all threads of a benchmark.
struct Server {
  Server() {
    ConfigureLogging("bench", LogLevel::kError);
    rpc::CreateIdentityKey(folder.path(), "gateway").IgnoreError();
    signer = *rpc::IdentitySigner::Load(folder.path(), "gateway");
    verifier = *rpc::IdentityVerifier::Load({.folder = folder.path()});
    rpc::DispatcherOptions options;
    options.verifier = verifier.get();
    options.registry = std::make_shared<prometheus::Registry>();
    dispatcher = rpc::Dispatcher::Create(options);
    handlers.read = [](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
      return ReadResponse();
    };
    rpc::ServerHost::Options host_options;
    host_options.dispatcher = dispatcher.get();
    host_options.services = {std::make_shared<ProbeAdapter>(dispatcher.get(), &handlers)};
    host = *rpc::ServerHost::Start(std::move(host_options));
    stub = ProbeService::NewStub(*rpc::MakeChannel(host->address(), {}));
  }

  TemporaryFolder folder;
  ProbeHandlers handlers;
  std::unique_ptr<rpc::IdentitySigner> signer;
  std::unique_ptr<rpc::IdentityVerifier> verifier;
  std::unique_ptr<rpc::Dispatcher> dispatcher;
  std::unique_ptr<rpc::ServerHost> host;
  std::unique_ptr<ProbeService::Stub> stub;
};

void BM_UnaryCall(benchmark::State& state) {
  static Server server;
  rpc::Origin origin;
  origin.identity = [identity = server.signer->Sign("users/ada", rpc::Role::kViewer, "r")] {
    return identity;
  };
  for (auto _ : state) {
    ReadResponse response;
    const grpc::Status status =
        server.stub->Read(rpc::MakeClientContext(origin).get(), {}, &response);
    if (!status.ok()) state.SkipWithError(status.error_message().c_str());
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_UnaryCall)->Threads(1)->Threads(16)->UseRealTime();

void BM_SignAndVerify(benchmark::State& state) {
  TemporaryFolder folder;
  rpc::CreateIdentityKey(folder.path(), "gateway").IgnoreError();
  const auto signer = *rpc::IdentitySigner::Load(folder.path(), "gateway");
  const auto verifier = *rpc::IdentityVerifier::Load({.folder = folder.path()});
  for (auto _ : state) {
    benchmark::DoNotOptimize(verifier->Verify(signer->Sign("users/ada", rpc::Role::kViewer, "r")));
  }
}
BENCHMARK(BM_SignAndVerify);

void BM_CheckMessage(benchmark::State& state) {
  ReadRequest request;
  for (int i = 0; i < 100; ++i) {
    Inner* part = request.add_parts();
    for (int j = 0; j < 100; ++j) part->add_numbers(static_cast<float>(j));
  }
  for (auto _ : state) benchmark::DoNotOptimize(rpc::CheckMessage(request));
  state.SetItemsProcessed(state.iterations() * 10000);
}
BENCHMARK(BM_CheckMessage);

}  // namespace
}  // namespace mortise::testing

BENCHMARK_MAIN();
