// Counts why designs could not be evaluated.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace mortise::evaluation {

// A design of D parameters that could not be evaluated, and why.
struct FailedDesign {
  std::string reason;  // the evaluator's constant ("RIGID_MOTION"); empty where it gives none
  absl::StatusCode code = absl::StatusCode::kUnknown;
  std::string message;  // for people
  Eigen::VectorXd x;    // D
};

// Designs that failed for one reason.
struct FailureCount {
  std::string reason;  // the evaluator's constant; the name of the code where it gives none
  absl::StatusCode code = absl::StatusCode::kUnknown;
  std::int64_t count = 0;
  // What follows is of the first of them.
  std::string message;
  Eigen::VectorXd x;         // D
  bool same_message = true;  // whether all said the very same
};

// Failures are alike if they have the same reason and their messages differ in numbers only. At
// most 16 kinds are told apart; what comes after them counts with the last kind, "OTHER".
class FailureTally {
 public:
  void Add(const FailedDesign& failed);

  // Returns the kinds of failures in the order in which they first came.
  const std::vector<FailureCount>& failures() const { return failures_; }

 private:
  std::vector<FailureCount> failures_;
  std::vector<std::string> keys_;  // of each: reason and message without numbers
};

// Whether several designs failed in the same words for what the subject of all may lack:
// FAILED_PRECONDITION, NOT_FOUND or UNIMPLEMENTED, but for reasons that tell of one design.
bool MayBeOfSubject(const FailureCount& failure);

// Says the counts by reason, the most frequent first: "5 RIGID_MOTION, 2 SINGULAR".
std::string CountsByReason(const std::vector<FailureCount>& failures);

// Says the same with an example of each: "5 RIGID_MOTION, such as 'nothing holds the seat'; 2 ...".
std::string CountsWithExamples(const std::vector<FailureCount>& failures);

}  // namespace mortise::evaluation
