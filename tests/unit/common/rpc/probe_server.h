// A server with ProbeService in the test's process, on a free port, with identity keys and a store
// of its own.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <prometheus/registry.h>

#include <memory>
#include <string>

#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/identity.h"
#include "common/rpc/server_host.h"
#include "common/rpc/status_mapping.h"
#include "common/store/store.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {

class ProbeServerTest : public ::testing::Test {
 protected:
  // Starts what `handlers_` says; call after setting them.
  void StartServer(absl::Duration drain_time = absl::Seconds(10)) {
    ASSERT_OK(rpc::CreateIdentityKey(keys(), "gateway"));
    ASSERT_OK(rpc::CreateIdentityKey(keys(), "probe"));
    gateway_ = *rpc::IdentitySigner::Load(keys(), "gateway");
    verifier_ = *rpc::IdentityVerifier::Load({.folder = keys()});
    auto store = store::OpenStore({.url = "sqlite:" + (folder_.path() / "probe.db").string(),
                                   .blob_folder = folder_.path() / "blobs",
                                   .service = "probe"});
    ASSERT_OK(store);
    store_ = *std::move(store);
    rpc::DispatcherOptions options;
    options.service = "probe";
    options.threads = 4;
    options.store = store_.get();
    options.verifier = verifier_.get();
    options.registry = registry_;
    dispatcher_ = rpc::Dispatcher::Create(options);
    rpc::ServerHost::Options host;
    host.metrics = "127.0.0.1:0";
    host.drain_time = drain_time;
    host.dispatcher = dispatcher_.get();
    host.registry = registry_;
    host.services = {std::make_shared<ProbeAdapter>(dispatcher_.get(), &handlers_)};
    auto started = rpc::ServerHost::Start(std::move(host));
    ASSERT_OK(started);
    host_ = *std::move(started);
    host_->SetReady();
    channel_ = *rpc::MakeChannel(host_->address(), {});
    stub_ = ProbeService::NewStub(channel_);
  }

  void TearDown() override {
    if (host_) host_->Shutdown();
    if (dispatcher_) dispatcher_->WaitIdle();
    host_.reset();
  }

  std::filesystem::path keys() const { return folder_.path() / "keys"; }

  rpc::Origin As(rpc::Role role, absl::Duration timeout = absl::Seconds(20)) const {
    rpc::Origin origin;
    origin.deadline = absl::Now() + timeout;
    origin.identity = [this, role] { return gateway_->Sign("users/ada", role, "trace-7"); };
    return origin;
  }

  std::unique_ptr<grpc::ClientContext> Context(rpc::Role role) const {
    return rpc::MakeClientContext(As(role));
  }

  absl::StatusOr<ReadResponse> Read(const ReadRequest& request = {},
                                    rpc::Role role = rpc::Role::kViewer) {
    ReadResponse response;
    const grpc::Status status = stub_->Read(Context(role).get(), request, &response);
    if (!status.ok()) return rpc::FromGrpc(status);
    return response;
  }

  absl::StatusOr<Kept> Keep(const KeepRequest& request, rpc::Role role = rpc::Role::kDesigner) {
    Kept response;
    const grpc::Status status = stub_->Keep(Context(role).get(), request, &response);
    if (!status.ok()) return rpc::FromGrpc(status);
    return response;
  }

  TemporaryFolder folder_;
  ProbeHandlers handlers_;
  std::shared_ptr<prometheus::Registry> registry_ = std::make_shared<prometheus::Registry>();
  std::unique_ptr<rpc::IdentitySigner> gateway_;
  std::unique_ptr<rpc::IdentityVerifier> verifier_;
  std::unique_ptr<store::Store> store_;
  std::unique_ptr<rpc::Dispatcher> dispatcher_;
  std::unique_ptr<rpc::ServerHost> host_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<ProbeService::Stub> stub_;
};

}  // namespace mortise::testing
