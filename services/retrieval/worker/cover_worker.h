// A worker leases families from the retrieval service, covers them in this process, and reports
// each cover with the attempt number that it was lent under.
#pragma once

#include <stop_token>

#include "common/host/worker_program.h"

namespace mortise::retrieval {

// Works until a stop is requested, with the channels "retrieval" and "catalog". The cover at hand
// is still finished and reported if that takes no longer than the drain time; else the family is
// given back, unharmed and at once. One that nobody wants any more, or that was lent to another
// meanwhile, is dropped before its next batch of designs, or after three seconds by breaking off. A
// worker holds no state that matters; when it dies its lease runs out and another takes the family,
// but for the covers of it that were reported.
void RunCoverWorker(const rpc::WorkerEnvironment& environment, const std::stop_token& stop);

// Is `mortise-retrieval --worker`: reads flags, handles signals and calls RunCoverWorker. Returns
// the exit code.
int WorkerMain(int argc, char** argv);

}  // namespace mortise::retrieval
