// The main program of a worker process.
#include "services/retrieval/worker/cover_worker.h"

namespace mortise::retrieval {

int WorkerMain(int argc, char** argv) {
  rpc::WorkerProgram program;
  program.name = "retrieval";
  program.title = "A retrieval worker: leases families of shapes and covers them for indexes.";
  program.peers = {"retrieval", "catalog"};
  program.work = [](const rpc::WorkerEnvironment& environment, const std::stop_token& stop) {
    RunCoverWorker(environment, stop);
    return absl::OkStatus();
  };
  return rpc::RunWorkerProgram(argc, argv, program);
}

}  // namespace mortise::retrieval
