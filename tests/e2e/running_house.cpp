#include "tests/e2e/running_house.h"

#include <vector>

#include "cli/launcher/state_folder.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"

namespace mortise::e2e {

RunningHouse::RunningHouse(int workers)
    : folder_(std::filesystem::temp_directory_path() / ("mortise-house-" + NewIdentifier())) {
  std::filesystem::create_directories(folder_);
  command_ = std::make_unique<BackgroundCommand>(
      std::vector<std::string>{"up", "--insecure-development", "--any-ports", "--workers",
                               std::to_string(workers), "--state", State()},
      (folder_ / "up.log").string());
  AwaitHouse(State());
}

RunningHouse::~RunningHouse() {
  command_.reset();
  std::filesystem::remove_all(folder_);
}

std::string RunningHouse::State() const { return (folder_ / "state").string(); }

bool RunningHouse::Serving() const {
  const auto house = cli::ReadRunningHouse(State());
  if (!house.ok() || house->processes.empty()) return false;
  for (const auto& process : house->processes) {
    if (!process.serving) return false;
  }
  return true;
}

std::string RunningHouse::GrpcAddress() const {
  const auto house = cli::ReadRunningHouse(State());
  return house.ok() ? house->gateway_grpc : "";
}

std::string RunningHouse::HttpAddress() const {
  const auto house = cli::ReadRunningHouse(State());
  return house.ok() ? house->gateway_http : "";
}

std::map<std::string, pid_t> RunningHouse::Processes() const {
  std::map<std::string, pid_t> pids;
  const auto house = cli::ReadRunningHouse(State());
  if (!house.ok()) return pids;
  for (const auto& process : house->processes) pids[process.name] = process.pid;
  return pids;
}

std::string RunningHouse::Log() const { return ReadFile(folder_ / "up.log").value_or(""); }

}  // namespace mortise::e2e
