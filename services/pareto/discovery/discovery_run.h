// Drives a discovery with an evaluator: batches, workers, progress, cancelling, checkpoints.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/discovery/ask_tell.h"

namespace mortise::pareto {

struct RunOptions {
  int batch_size = 1;  // designs in one call of the evaluator, at most
  int lanes = 1;  // calls under way at once. Neither changes the front, only the time it takes.
  std::function<bool()> cancelled;  // asked ten times a second; true: stop with what was found
  std::function<void(const AskTell::Summary&)> progress;  // after each batch
  // Called each time that no answer has come for `quiet`, with how long there has been none, to how
  // many calls.
  std::function<void(std::chrono::seconds, int calls)> waiting;
  std::chrono::milliseconds quiet{10'000};
  // Called after each batch. A non-OK status, which says why the whole subject is at fault, ends
  // the run.
  std::function<absl::Status(const AskTell::Summary&)> judge;
  // Called after each batch with its results by proposal number, before anything else happens with
  // them. A non-OK status stops the run as if the evaluator were lost.
  std::function<absl::Status(const std::vector<std::pair<std::int64_t, Evaluation>>&)> checkpoint;
};

// Runs until the discovery has finished; calls the callbacks on the calling thread. Results that
// are already known (from an interrupted run) are taken from `known` before the evaluator is asked.
// Returns the evaluator's failure, if that is what stopped it (the discovery then keeps what it
// found); DATA_LOSS if `known` belongs to another discovery.
absl::Status Run(AskTell& discovery, Evaluator& evaluator, const RunOptions& options,
                 const std::map<std::int64_t, Evaluation>& known = {});

// The state of an interrupted discovery: since proposals depend only on the options and on earlier
// answers, the answers are all of it.
struct DiscoveryCheckpoint {
  std::map<std::int64_t, Evaluation> results;  // by proposal number
};

// Writes a checkpoint as bytes: little-endian, doubles bit for bit, checked on reading. Several
// serialised checkpoints may be concatenated and are read as one, so that a run can append what
// each batch adds.
std::string Serialize(const DiscoveryCheckpoint& checkpoint);

// Reads what Serialize wrote; DATA_LOSS when the bytes are not such.
absl::StatusOr<DiscoveryCheckpoint> ParseCheckpoint(std::string_view bytes);

}  // namespace mortise::pareto
