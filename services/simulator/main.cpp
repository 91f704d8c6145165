// mortise-simulator: the service, or with --worker a worker of it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>

#include "services/simulator/service/simulator_service.h"
#include "services/simulator/worker/worker.h"

int main(int argc, char** argv) {
  const bool worker =
      std::any_of(argv + 1, argv + argc, [](std::string_view word) { return word == "--worker"; });
  if (worker) return mortise::simulator::WorkerMain(argc, argv);
  double file_quota = mortise::simulator::kDefaultFileQuota / 1e9;
  mortise::rpc::ServiceDescription description;
  description.name = "simulator";
  description.title =
      "The simulator: queues evaluations for workers (--worker makes one of this program).";
  description.add_flags = [&file_quota](CLI::App& app) {
    app.add_option("--file-disk-quota", file_quota,
                   "GB of disk that uploaded meshes, files of analyses and shapes and fields of "
                   "designs may take together; the oldest that nothing names make room")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->envname("MORTISE_FILE_DISK_QUOTA");
  };
  return mortise::rpc::RunService(
      argc, argv, description, [&file_quota](mortise::rpc::ServiceEnvironment& environment) {
        return mortise::simulator::MakeServices(environment, 1e9 * file_quota);
      });
}
