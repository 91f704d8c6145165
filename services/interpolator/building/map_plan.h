// What a map is to be of: which parameters of a design vary how far, and what is to be known of
// them.
//
// Notation of this folder: D parameters of the subject, P of them vary, K of those are numbers that
// are sampled between their ends and the others whole; M metrics.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mortise::interpolator {

// A parameter that varies.
struct PlannedParameter {
  std::string name;
  std::string unit;
  Eigen::Index index = 0;  // of the subject's parameters
  double minimum = 0;
  double maximum = 0;
  bool whole = false;                  // a whole number or a choice
  std::vector<double> values{};        // of a whole one those that are wanted, ascending
  std::vector<std::string> choices{};  // of a choice the names of 0, 1, …
};

struct PlannedMetric {
  std::string name;
  std::string unit;
  double noise_floor = 0;
};

struct MapPlan {
  std::vector<PlannedParameter> parameters;  // in the subject's order: the P numbers of a point
  std::vector<std::string> names;            // of all D parameters of the subject
  Eigen::VectorXd base;                      // D: what is fixed, and defaults of the others
  std::vector<PlannedMetric> metrics;        // M
  int evaluations = 0;                       // of all structures together
  // One column each: the values of the whole parameters, in their order. One without rows where
  // none varies.
  Eigen::MatrixXd structures;

  // Which of the parameters are no whole ones, K of them, and which are.
  std::vector<std::size_t> NumberParameters() const;
  std::vector<std::size_t> WholeParameters() const;

  // Returns the D values of a design: of a structure and a place u in [0, 1]^K of its box.
  Eigen::VectorXd DesignAt(Eigen::Index structure, const Eigen::VectorXd& u) const;
  // Returns the D values of a design by the P values of a point.
  Eigen::VectorXd DesignOf(const Eigen::VectorXd& point) const;
  // Returns the P values of a point by the D values of a design.
  Eigen::VectorXd PointOf(const Eigen::VectorXd& design) const;
};

}  // namespace mortise::interpolator
