// What of a request's settings its results depend on, for their keys.
#pragma once

#include <string>

#include "mortise/v1/evaluator.pb.h"

namespace mortise::simulator {

// Beside size and order of the elements; empty where nothing is refined.
std::string RefinementText(const v1::MeshSettings& settings);

// Empty where all are left out.
std::string AirflowText(const v1::AirflowSettings& settings);

}  // namespace mortise::simulator
