// mortise-simulator, as service or worker, as a process that the test starts, kills and starts
// again.
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
#include <utility>
#include <vector>

namespace mortise::simulator {

class SimulatorProcess {
 public:
  explicit SimulatorProcess(const std::vector<std::string>& flags) {
    const char* programs = std::getenv("MORTISE_BIN_DIR");
    const std::string program =
        std::string(programs == nullptr ? "build/release/bin" : programs) + "/mortise-simulator";
    std::vector<std::string> words = {program, "--insecure-development", "--log-level=warning"};
    words.insert(words.end(), flags.begin(), flags.end());
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    process_ = ::fork();
    if (process_ == 0) {
      ::execv(program.c_str(), arguments.data());
      ::_exit(127);
    }
  }
  ~SimulatorProcess() { End(SIGTERM); }

  // Sends the signal and waits for the end; the exit code, or minus the signal that ended it.
  int End(int signal) {
    if (process_ <= 0) return 0;
    ::kill(process_, signal);
    int status = 0;
    ::waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t process_ = -1;
};

// The service on a state folder; restartable.
class ServiceUnderTest {
 public:
  ServiceUnderTest(std::filesystem::path folder, std::string catalog)
      : folder_(std::move(folder)), catalog_(std::move(catalog)) {
    Start();
  }

  void Start() {
    const std::filesystem::path port_file = folder_ / "address.json";
    std::filesystem::remove(port_file);
    // The same port after a restart, so that workers find the service again.
    process_ = std::make_unique<SimulatorProcess>(std::vector<std::string>{
        "--store=sqlite:" + (folder_ / "simulator.db").string(),
        "--blobs=" + (folder_ / "blobs").string(), "--port-file=" + port_file.string(),
        "--peer=catalog=" + catalog_, "--listen=" + (address_.empty() ? "127.0.0.1:0" : address_)});
    // Another process has no condition variable: look for its file until it is there.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (address_ = ReadAddress(port_file), address_.empty()) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("no port file");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    channel_ = grpc::CreateChannel(address_, grpc::InsecureChannelCredentials());
  }

  void Kill() { process_->End(SIGKILL); }

  const std::string& address() const { return address_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  std::unique_ptr<SimulatorProcess> StartWorker(const std::string& name) const {
    return std::make_unique<SimulatorProcess>(std::vector<std::string>{
        "--worker", "--worker-name=" + name, "--peer=simulator=" + address_,
        "--peer=catalog=" + catalog_, "--lease-seconds=2"});
  }

 private:
  static std::string ReadAddress(const std::filesystem::path& port_file) {
    std::ifstream file(port_file);
    const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
    return json.is_object() ? json.value("grpc", "") : "";
  }

  const std::filesystem::path folder_;
  const std::string catalog_;
  std::string address_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<SimulatorProcess> process_;
};

}  // namespace mortise::simulator
