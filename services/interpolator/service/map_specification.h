// What is wrong with a request for a map, as far as that needs no evaluator.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace mortise::v1 {
class MapSpecification;
}

namespace mortise::interpolator {

inline constexpr int kMaxMetrics = 100;
inline constexpr int kMaxParameters = 200;  // of a subject
inline constexpr int kMaxNumbers = 6;       // parameters that are sampled between their ends
inline constexpr int kMaxCubicNumbers = 5;
inline constexpr int kMinEvaluations = 10;
inline constexpr int kMaxEvaluations = 1'000'000;
inline constexpr int kDefaultEvaluations = 1000;
inline constexpr int kMaxValues =
    20'000'000;  // evaluations times metrics: what a map's file may hold
inline constexpr int kMaxFields = 100;
inline constexpr int kMaxRegions = 1000;
inline constexpr int kMaxModes = 100;
inline constexpr int kMaxStructures = 100;
inline constexpr int kDefaultStructures = 10;
inline constexpr double kMaxSeconds = 1e7;

// Fails with INVALID_ARGUMENT that names all fields at fault ("specification.evaluations"): counts,
// ranges, names given twice.
absl::Status CheckSpecification(const v1::MapSpecification& specification);

// Fails with INVALID_ARGUMENT naming "subject" unless it is templates/{id} or evaluators/{id}.
absl::Status CheckSubject(const std::string& subject);

}  // namespace mortise::interpolator
