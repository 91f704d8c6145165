// What can be evaluated: a template of the catalog, by our own finite elements, or an evaluator
// that somebody registered, by its workers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/channel.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

class SimulatorCore;

struct EvaluationSubject {
  v1::DesignSpace space = {};  // with subject and revision
  std::string digest = {};     // of all that results depend on, but for points and metrics
  std::string queue = {};      // where its tasks go
};

// Finds a revision of templates/{id} or evaluators/{id}, the latest for 0, with the metrics that a
// request defines. INVALID_ARGUMENT naming "subject" or what is wrong below "metric_definitions";
// NOT_FOUND; UNAVAILABLE while the catalog cannot be reached.
absl::StatusOr<EvaluationSubject> FindSubject(SimulatorCore& core, const std::string& name,
                                              int64_t revision,
                                              const v1::MetricDefinitions& definitions,
                                              const rpc::Origin& origin);

// Fails with INVALID_ARGUMENT naming "metrics[i]" (or "metrics" if there are none) unless all are
// offered.
absl::Status CheckMetrics(const v1::DesignSpace& space, const std::vector<std::string>& metrics);

// Fails with INVALID_ARGUMENT naming "`field`.parameters[k]" unless the point is within the space.
absl::Status CheckPoint(const v1::DesignSpace& space, const v1::DesignPoint& point,
                        const std::string& field);

// Whether a worker's result is what its task asked for: the metrics in their order, gradients if
// asked for of just those metrics that offer them, one value for each parameter. Units may be left
// out, and are then filled in. INVALID_ARGUMENT naming "result.metrics[1].name" and the like.
absl::Status CompleteResult(const v1::Task& task, const v1::DesignSpace& space,
                            v1::EvaluationResult& result);

// Tells which numbers of a result are NaN or infinite, for people: "mass", "the gradient of mass,
// the gradient of cost". Empty if all are finite.
std::string WhatIsNotFinite(const v1::EvaluationResult& result);

}  // namespace mortise::simulator
