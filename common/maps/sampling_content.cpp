// What a sampling states of its map: the content, and how far that is off at probes.
#include <algorithm>
#include <set>

#include "common/maps/sampling_state.h"

namespace mortise::maps {

MapErrors MapSampling::State::Errors() const {
  return options_.basis == Basis::kLinear ? LinearErrors() : smooth_errors_;
}

MapErrors MapSampling::State::LinearErrors() const {
  MapErrors errors;
  errors.largest = errors.mean = Eigen::VectorXd::Zero(outputs_);
  errors.range = Scale();
  std::set<int> counted;
  for (std::size_t node = 0; node < measured_.size(); ++node) {
    if (!tree_.IsElement(static_cast<int>(node))) continue;
    const Measured& measured = measured_[node];
    for (Eigen::Index n = 0; n < measured.differences.cols() && !measured.cut_off(); ++n) {
      if (!counted.insert(measured.probes[n]).second) continue;
      errors.largest = errors.largest.cwiseMax(measured.differences.col(n));
      errors.mean += measured.differences.col(n);
      ++errors.probes;
    }
  }
  if (errors.probes > 0) errors.mean /= errors.probes;
  return errors;
}

double MapSampling::State::LargestOutsideError() const {
  double largest = 0;
  for (const int element : tree_.Elements()) {
    const Measured& measured = measured_[element];
    if (measured.cut_off() || measured.lacks_outside()) continue;
    largest = std::max(largest, measured.outside.error);
  }
  return largest;
}

int MapSampling::State::CutOffCount() const {
  int count = 0;
  for (const int element : tree_.Elements()) count += measured_[element].cut_off() ? 1 : 0;
  return count;
}

int MapSampling::State::LackingOutsideCount() const {
  int count = 0;
  for (const int element : tree_.Elements()) count += measured_[element].lacks_outside() ? 1 : 0;
  return count;
}

MapContent MapSampling::State::Content() const {
  MapContent content = LinearContent();
  content.basis = options_.basis;
  if (options_.basis == Basis::kCubic) MeasureCubic(content);
  return content;
}

MapContent MapSampling::State::LinearContent() const {
  MapContent content;
  content.dimension = tree_.dimension();
  content.basis = tree_.basis();
  content.options = tree_.options();
  content.splits.assign(tree_.history().begin(),
                        tree_.history().begin() + static_cast<std::ptrdiff_t>(complete_splits_));
  const auto complete =
      *RefinementTree::Replay(content.dimension, content.basis, content.options, content.splits);
  content.values = Eigen::MatrixXd::Zero(outputs_, complete.sample_count());
  for (int sample = 0; sample < complete.sample_count(); ++sample) {
    const int number = sample_points_[sample];
    if (points_.StateOf(number) == KnownPoints::State::kGood) {
      content.values.col(sample) = points_.ValuesOf(number);
    }
  }
  content.errors = Eigen::MatrixXd::Zero(outputs_, complete.element_count());
  for (const int element : complete.Elements()) {
    const auto order = static_cast<Eigen::Index>(content.cut_off.size());
    const Stated stated = StatedOf(element);
    content.errors.col(order) = stated.errors;
    content.cut_off.push_back(stated.cut_off ? 1 : 0);
  }
  return content;
}

// Replaces the errors by those of the cubic map. Returns them at all probes, each once.
MapErrors MapSampling::State::MeasureCubic(MapContent& content) const {
  const auto map = *InterpolationMap::Create(content);
  MapErrors errors;
  errors.largest = errors.mean = Eigen::VectorXd::Zero(outputs_);
  errors.range = Scale();
  content.errors.setZero();
  std::set<int> counted;
  Eigen::Index order = 0;
  for (const int element : map.tree().Elements()) {
    const Measured& measured = measured_[element];
    for (std::size_t n = 0; n < measured.probes.size() && !measured.cut_off(); ++n) {
      const int number = measured.probes[n];
      const Eigen::VectorXd position = UnitPosition(points_.PositionOf(number), tree_.dimension());
      if (map.tree().elements().FindSample(points_.PositionOf(number)) >= 0) continue;
      const Eigen::VectorXd difference =
          (map.Evaluate(position).values.col(0) - points_.ValuesOf(number)).cwiseAbs();
      if (!difference.allFinite()) continue;  // on a face of what is cut off
      content.errors.col(order) = content.errors.col(order).cwiseMax(difference);
      if (!counted.insert(number).second) continue;
      errors.largest = errors.largest.cwiseMax(difference);
      errors.mean += difference;
      ++errors.probes;
    }
    ++order;
  }
  if (errors.probes > 0) errors.mean /= errors.probes;
  return errors;
}

void MapSampling::State::MeasureSmooth() {
  MapContent content = LinearContent();
  content.basis = options_.basis;
  smooth_errors_ = MeasureCubic(content);
  smooth_enough_ = true;
  for (Eigen::Index order = 0; order < content.errors.cols(); ++order) {
    const bool small = RelativeError(content.errors.col(order), options_.noise_floor,
                                     smooth_errors_.range) <= options_.tolerance;
    smooth_enough_ = smooth_enough_ && small;
  }
}

}  // namespace mortise::maps
