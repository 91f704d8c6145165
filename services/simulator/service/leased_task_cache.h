// Keeps what evaluators' tasks that are at work ask for, from when they are leased: reports are
// checked against it, and need not read it again.
#pragma once

#include <memory>
#include <string>

#include "common/base/single_flight_cache.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

// A task at work, and the evaluator that it asks.
struct LeasedTask {
  v1::Task task;  // as it was queued
  std::shared_ptr<const v1::Evaluator> evaluator;
};

// Keeps the latest of them; any thread may use it.
class LeasedTaskCache {
 public:
  // Returns the evaluator with this digest; nothing if it is not known.
  std::shared_ptr<const v1::Evaluator> FindEvaluator(const std::string& digest);
  std::shared_ptr<const v1::Evaluator> PutEvaluator(const std::string& digest,
                                                    v1::Evaluator evaluator);

  // Returns the task with this key, which tells its content and its evaluator's; nothing if it is
  // not known.
  std::shared_ptr<const LeasedTask> Find(const std::string& key);
  void Put(const std::string& key, LeasedTask leased);

 private:
  SingleFlightCache<std::shared_ptr<const v1::Evaluator>> evaluators_{std::size_t{16} << 20};
  SingleFlightCache<std::shared_ptr<const LeasedTask>> tasks_{std::size_t{16} << 20};
};

}  // namespace mortise::simulator
