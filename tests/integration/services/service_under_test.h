// A service of the house as a process with state of its own, which a test kills and starts again.
#pragma once

#include <grpcpp/grpcpp.h>
#include <signal.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/reserved_port.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

class ServiceUnderTest {
 public:
  // Starts `program` with `flags`, on blobs in a folder of its own, and on a store there unless the
  // URL of another is given. `state`: a folder whose content they begin with; empty for nothing.
  ServiceUnderTest(std::string program, std::vector<std::string> flags, std::string store = {},
                   const std::filesystem::path& state = {})
      : program_(std::move(program)), flags_(std::move(flags)) {
    if (!state.empty()) {
      std::filesystem::copy(state, folder_.path(), std::filesystem::copy_options::recursive);
    }
    if (store.empty()) store = "sqlite:" + (folder_.path() / "store.db").string();
    flags_.insert(flags_.end(),
                  {"--insecure-development", "--log-level=warning", "--listen=" + port_.address(),
                   "--store=" + store, "--blobs=" + (folder_.path() / "blobs").string()});
    Start();
  }

  // Starts it (again), at the same address and on the same state, and waits until it serves.
  void Start() {
    process_ = std::make_unique<ServiceProcess>(BuiltProgram(program_), flags_,
                                                folder_.path() / "address.json");
    // Not a connection to the process before, which may not have noticed that it is dead.
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    channel_ = grpc::CreateCustomChannel(address(), grpc::InsecureChannelCredentials(), arguments);
  }

  // kill -9.
  void Kill() { process_->End(SIGKILL); }

  const std::string& address() const { return port_.address(); }
  // Where its store and its blobs are.
  const std::filesystem::path& folder() const { return folder_.path(); }
  pid_t pid() const { return process_->pid(); }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

 private:
  const std::string program_;
  std::vector<std::string> flags_;
  const ReservedPort port_;
  const TemporaryFolder folder_;
  std::unique_ptr<ServiceProcess> process_;
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace mortise::testing
