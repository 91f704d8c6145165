// The rounds of an adaptive sampling. Private to this folder: others use map_sampling.h.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "common/maps/known_points.h"
#include "common/maps/map_sampling.h"
#include "common/maps/refinement_tree.h"

namespace mortise::maps {

class MapSampling::State {
 public:
  State(RefinementTree tree, int outputs, MapSamplingOptions options);

  int outputs() const { return outputs_; }
  const RefinementTree& tree() const { return tree_; }
  KnownPoints& points() { return points_; }
  const KnownPoints& points() const { return points_; }
  bool done() const { return done_; }

  void SetNoiseFloor(std::vector<double> noise_floor) {
    options_.noise_floor = std::move(noise_floor);
  }
  std::vector<AskedPoint> Ask(int most);
  bool WasAsked(int number) const { return handed_out_[number] != 0; }
  void MarkAsked(int number) { handed_out_[number] = 1; }
  // To be called after each answer: begins the next rounds if this one is complete.
  void GoOn();

  // Elements whose error from outside the round waits for.
  const std::set<int>& awaited() const { return awaited_; }
  const std::vector<std::pair<int, OutsideError>>& told_errors() const { return told_errors_; }
  // To be called for elements of which no point has failed, while any is awaited.
  void TellError(int element, const OutsideError& error);

  int PointOfSample(int sample) const { return sample_points_[sample]; }
  const std::vector<int>& ProbesOf(int element) const { return measured_[element].probes; }
  bool HasFailedPoint(int element) const { return measured_[element].has_failed; }
  bool IsCutOff(int element) const { return measured_[element].cut_off(); }

  MapErrors Errors() const;
  double LargestOutsideError() const;
  int CutOffCount() const;
  int LackingOutsideCount() const;
  bool HasContent() const { return rounds_ > 0; }
  MapContent Content() const;

 private:
  // What is known of a node while it is, or was, an element.
  struct Measured {
    std::vector<int> probes;      // known points in the closed box that are no samples
    Eigen::MatrixXd differences;  // outputs × probes, of those that did not fail
    Eigen::VectorXd errors;       // the largest of each output
    bool has_failed = false;      // a point of it
    bool all_failed = false;
    // What was interpolated at its probes when its error from outside was last awaited.
    std::vector<PointWeights> weights;
    std::size_t samples = 0;  // how many it had then
    OutsideError outside;

    // Whether nothing is interpolated over it.
    bool cut_off() const { return has_failed || (errors.size() == 0 && outside.failed); }
    // Whether outputs are all that is interpolated over it.
    bool lacks_outside() const { return !cut_off() && outside.failed; }
  };
  // What of an element a map states.
  struct Stated {
    Eigen::VectorXd errors;
    bool cut_off = false;
  };
  struct Candidate {
    double priority = 0;
    int element = 0;
    bool shrinks = false;  // split to make small what fails, rather than for its error
  };

  int Want(const LatticePoint& position, bool probe);
  void PlaceProbes(int element);
  std::vector<LatticePoint> MissingProbes(const LatticeBox& box, const std::vector<int>& own) const;
  void WantSamples(const std::vector<int>& samples);
  void MeasureRound();
  void CompleteRound();
  void Measure(int element);
  void MeasureOutputs(Measured& measured, const std::vector<PointWeights>& weights);
  void AwaitError(int element, std::vector<PointWeights> weights);
  void KeepStated(int element);
  Stated StatedOf(int element) const;
  double ErrorOfOutputs(const Measured& measured, const Eigen::VectorXd& scale) const;
  Eigen::VectorXd DirectionScores(const Candidate& candidate) const;
  bool StartRound();
  MapContent LinearContent() const;
  MapErrors MeasureCubic(MapContent& content) const;
  void MeasureSmooth();
  MapErrors LinearErrors() const;
  std::vector<Candidate> Candidates() const;
  bool MayShrink(int element) const;
  double ErrorOf(const Measured& measured, const Eigen::VectorXd& scale) const;
  int DirectionFor(const Candidate& candidate) const;
  int CostOf(int element, int direction) const;
  bool SplitElement(const Candidate& candidate, int direction);
  Eigen::VectorXd Scale() const;
  std::vector<int> PointsAround(int element) const;

  int outputs_;
  MapSamplingOptions options_;
  RefinementTree tree_;  // linear, whatever the map's basis: its errors choose where to split
  KnownPoints points_;
  std::vector<std::uint8_t> handed_out_;
  int next_to_hand_out_ = 0;
  std::vector<int> sample_points_;  // the point of each sample
  std::vector<Measured> measured_;  // for each node
  std::vector<int> changed_;        // elements that this round makes
  bool is_measured_ = false;        // whether this round has no more than errors to wait for
  std::set<int> awaited_;           // elements
  std::vector<std::pair<int, OutsideError>> told_errors_;
  std::map<int, Stated> stated_;  // of the last complete round, of what this one has changed
  int shrinking_asked_ = 0;       // points that splits to make small what fails have cost
  int rounds_ = 0;
  std::size_t complete_splits_ = 0;  // of the history, when the last round was complete
  // Of a cubic map, which is measured whenever half as many points again are known: it takes all of
  // the map.
  MapErrors smooth_errors_;
  bool smooth_enough_ = false;
  int next_smooth_ = 0;
  bool done_ = false;
};

}  // namespace mortise::maps
