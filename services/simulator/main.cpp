// mortise-simulator: the service, or with --worker a worker of it.
#include <algorithm>
#include <string_view>

#include "services/simulator/service/simulator_service.h"
#include "services/simulator/worker/worker.h"

int main(int argc, char** argv) {
  const bool worker =
      std::any_of(argv + 1, argv + argc, [](std::string_view word) { return word == "--worker"; });
  if (worker) return mortise::simulator::WorkerMain(argc, argv);
  return mortise::rpc::RunService(
      argc, argv,
      {.name = "simulator",
       .title =
           "The simulator: queues evaluations for workers (--worker makes one of this program)."},
      mortise::simulator::MakeServices);
}
