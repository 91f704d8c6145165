// mortise-fabplanner as a process of its own that the test starts, kills and starts again.
#pragma once

#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace mortise::fabplanner {

class ServiceProcess {
 public:
  explicit ServiceProcess(std::string catalog_address)
      : catalog_address_(std::move(catalog_address)) {
    Start();
  }
  ~ServiceProcess() { End(SIGTERM); }

  // kill -9.
  void Kill() { End(SIGKILL); }

  void Start() {
    const std::filesystem::path folder = folder_.path();
    const std::filesystem::path port_file = folder / "address.json";
    std::filesystem::remove(port_file);
    const char* programs = std::getenv("MORTISE_BIN_DIR");
    const std::string program =
        std::string(programs == nullptr ? "build/release/bin" : programs) + "/mortise-fabplanner";
    const std::vector<std::string> words = {program,
                                            "--insecure-development",
                                            "--store=sqlite:" + (folder / "fabplanner.db").string(),
                                            "--blobs=" + (folder / "blobs").string(),
                                            "--port-file=" + port_file.string(),
                                            "--peer=catalog=" + catalog_address_,
                                            "--log-level=warning"};
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    process_ = ::fork();
    if (process_ == 0) {
      ::execv(program.c_str(), arguments.data());
      ::_exit(127);
    }
    // Another process has no condition variable: look for its file until it is there.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (address_ = ReadAddress(port_file), address_.empty()) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("no port file");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    channel_ = grpc::CreateChannel(address_, grpc::InsecureChannelCredentials());
  }

  const std::string& address() const { return address_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

 private:
  static std::string ReadAddress(const std::filesystem::path& port_file) {
    std::ifstream file(port_file);
    const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
    return json.is_object() ? json.value("grpc", "") : "";
  }

  void End(int signal) {
    if (process_ <= 0) return;
    ::kill(process_, signal);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }

  const std::string catalog_address_;
  testing::TemporaryFolder folder_;
  std::string address_;
  std::shared_ptr<grpc::Channel> channel_;
  pid_t process_ = -1;
};

}  // namespace mortise::fabplanner
