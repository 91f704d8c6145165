// What an evaluator says of a design.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"

namespace mortise::interpolator {

struct DesignAnswer {
  absl::Status status;     // why it could not be evaluated; OK if it was
  Eigen::VectorXd values;  // M
  // Digest of the file with its shape and fields (common/fields), of maps that have such: what
  // ShapeOptions::get gives.
  std::string file{};
};

}  // namespace mortise::interpolator
