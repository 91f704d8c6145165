// Measures slopes and curvature of all metrics at a design by differences.
//
// It takes central differences for slopes and second differences for curvature: n (n + 3) / 2
// evaluations for n parameters, all known at once. That is worth it where a whole piece of the
// front is to be followed along what they tell, since what is off there is off everywhere on the
// piece.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "services/pareto/models/quadratic_model.h"

namespace mortise::pareto {

class DifferenceModel {
 public:
  // Measures at `model`'s centre, along some of the coordinates. Steps are of unit coordinates;
  // where one would leave the box, both are taken to the other side.
  DifferenceModel(const QuadraticModel& model, std::vector<Eigen::Index> coordinates, double step);

  // Returns how many evaluations it takes for so many coordinates.
  static Eigen::Index Evaluations(Eigen::Index coordinates) {
    return coordinates * (coordinates + 3) / 2;
  }

  Eigen::Index evaluations() const { return static_cast<Eigen::Index>(points_.size()); }

  std::optional<Eigen::VectorXd> Ask();

  // Takes the metrics of the next point in the order asked for; nothing where it failed.
  void Tell(const std::optional<Eigen::VectorXd>& metrics);

  bool Finished() const { return told_.size() == points_.size(); }

  // Returns the model, with slopes and curvature of the coordinates as measured. Those that needed
  // a point that failed stay as they were.
  QuadraticModel Measured() const;

 private:
  QuadraticModel model_;
  std::vector<Eigen::Index> coordinates_;
  std::vector<double> first_, second_;  // steps of each coordinate
  std::vector<Eigen::VectorXd> points_;
  std::vector<std::optional<Eigen::VectorXd>> told_;  // first steps, second steps, pairs of first
  std::size_t asked_ = 0;
};

}  // namespace mortise::pareto
