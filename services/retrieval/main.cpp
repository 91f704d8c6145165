// mortise-retrieval: the service that finds templates by shape, or with --worker a worker of it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <thread>

#include "common/host/run_service.h"
#include "common/mesh/scenes/scene_reader.h"
#include "services/retrieval/service/retrieval_service.h"
#include "services/retrieval/worker/cover_worker.h"

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::mesh::kSceneChildArgument) {
    return mortise::mesh::RunSceneChild();
  }
  const bool is_worker =
      std::any_of(argv + 1, argv + argc, [](std::string_view word) { return word == "--worker"; });
  if (is_worker) return mortise::retrieval::WorkerMain(argc, argv);
  int cover_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  mortise::rpc::ServiceDescription description;
  description.name = "retrieval";
  description.title =
      "Finds the templates that can become a given shape (--worker makes a worker of this "
      "program).";
  description.add_flags = [&cover_threads](CLI::App& app) {
    app.add_option("--cover-threads", cover_threads,
                   "families that the service itself covers at a time; 0 leaves all to workers")
        ->check(CLI::Range(0, 256))
        ->capture_default_str()
        ->envname("MORTISE_COVER_THREADS");
  };
  return mortise::rpc::RunService(
      argc, argv, description, [&](mortise::rpc::ServiceEnvironment& environment) {
        return mortise::retrieval::MakeServices(environment, cover_threads);
      });
}
