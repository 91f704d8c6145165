// What evaluators' tasks that are at work ask for, kept from when they are leased: reports are
// checked against it, and need not read it again.
#pragma once

#include <memory>
#include <string>

#include "common/base/single_flight_cache.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

struct LentTask {
  v1::Task task;  // as it was queued
  std::shared_ptr<const v1::Evaluator> evaluator;
};

// The latest of them. Thread safe.
class LentTasks {
 public:
  // An evaluator by its digest, nothing if it is not known.
  std::shared_ptr<const v1::Evaluator> FindEvaluator(const std::string& digest);
  std::shared_ptr<const v1::Evaluator> PutEvaluator(const std::string& digest,
                                                    v1::Evaluator evaluator);

  // A task by its key, which tells its content and its evaluator's; nothing if it is not known.
  std::shared_ptr<const LentTask> Find(const std::string& key);
  void Put(const std::string& key, LentTask lent);

 private:
  SingleFlightCache<std::shared_ptr<const v1::Evaluator>> evaluators_{std::size_t{16} << 20};
  SingleFlightCache<std::shared_ptr<const LentTask>> tasks_{std::size_t{16} << 20};
};

}  // namespace mortise::simulator
