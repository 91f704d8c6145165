// mortise-fabplanner: the fabrication planner as a process.
#include <cstdlib>

#include "common/host/run_service.h"
#include "services/fabplanner/service/fabplanner_service.h"

int main(int argc, char** argv) {
  // A released work order waits for its machines on a thread of its own, which costs next to
  // nothing; the usual two would let two orders keep everybody else from planning.
  setenv("MORTISE_OPERATION_THREADS", "34", /*overwrite=*/0);
  return mortise::rpc::RunService(
      argc, argv, {.name = "fabplanner", .title = "Plans fabrication and runs work orders"},
      mortise::fabplanner::MakeServices);
}
