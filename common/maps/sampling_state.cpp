#include "common/maps/sampling_state.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/random.h"
#include "common/maps/local_model.h"

namespace mortise::maps {
namespace {

// Elements of less than this share of the round's first priority wait for another round.
constexpr double kRoundShare = 0.5;
// The share of the budget that may go into making small what fails.
constexpr double kShrinkingShare = 0.25;
// No element of fewer splits is believed to be good: two probes may both be right by chance.
constexpr int kLeastDepth = 2;
// Priority is error × volume^kSizePower.
constexpr double kSizePower = 0.5;

bool InClosedBox(const LatticeBox& box, const LatticePoint& point, int dimension) {
  for (int d = 0; d < dimension; ++d) {
    if (point[d] < box.low[d] || point[d] > box.high[d]) return false;
  }
  return true;
}

bool InOpenBox(const LatticeBox& box, const LatticePoint& point, int dimension) {
  for (int d = 0; d < dimension; ++d) {
    if (point[d] <= box.low[d] || point[d] >= box.high[d]) return false;
  }
  return true;
}

bool IsSame(const PointWeights& a, const PointWeights& b) {
  return a.samples == b.samples && a.weights == b.weights;
}

LatticePoint CentreOf(const LatticeBox& box, int dimension) {
  LatticePoint centre{};
  for (int d = 0; d < dimension; ++d) centre[d] = box.low[d] + (box.high[d] - box.low[d]) / 2;
  return centre;
}

}  // namespace

MapSampling::State::State(RefinementTree tree, int outputs, MapSamplingOptions options)
    : outputs_(outputs),
      options_(std::move(options)),
      tree_(std::move(tree)),
      points_(outputs),
      measured_(1) {
  std::vector<int> corners(tree_.sample_count());
  for (int sample = 0; sample < tree_.sample_count(); ++sample) corners[sample] = sample;
  WantSamples(corners);
  PlaceProbes(0);
  changed_ = {0};
}

int MapSampling::State::Want(const LatticePoint& position, bool probe) {
  const int number = points_.Want(position, probe);
  handed_out_.resize(points_.count(), 0);
  return number;
}

void MapSampling::State::WantSamples(const std::vector<int>& samples) {
  for (const int sample : samples) {
    sample_points_.push_back(Want(tree_.SampleLattice(sample), false));
  }
}

// The centre, and a seeded point a quarter of the edges away from it, unless `own` has another one
// inside already.
std::vector<LatticePoint> MapSampling::State::MissingProbes(const LatticeBox& box,
                                                            const std::vector<int>& own) const {
  const LatticePoint centre = CentreOf(box, tree_.dimension());
  std::vector<LatticePoint> missing = {centre};
  const bool has_other = std::any_of(own.begin(), own.end(), [&](int number) {
    const LatticePoint& position = points_.PositionOf(number);
    return position != centre && InOpenBox(box, position, tree_.dimension());
  });
  if (!has_other) {
    Random random(options_.seed ^ LatticeHash()(centre));
    LatticePoint second = centre;
    for (int d = 0; d < tree_.dimension(); ++d) {
      const std::int32_t quarter = (box.high[d] - box.low[d]) / 4;
      second[d] += random.Index(2) == 0 ? -quarter : quarter;
    }
    missing.push_back(second);
  }
  return missing;
}

void MapSampling::State::PlaceProbes(int element) {
  std::vector<int>& probes = measured_[element].probes;
  for (const LatticePoint& position : MissingProbes(tree_.LatticeBoxOf(element), probes)) {
    const int number = Want(position, true);
    if (std::find(probes.begin(), probes.end(), number) == probes.end()) probes.push_back(number);
  }
}

std::vector<AskedPoint> MapSampling::State::Ask(int most) {
  std::vector<AskedPoint> asked;
  while (next_to_hand_out_ < points_.count() && static_cast<int>(asked.size()) < most) {
    const int number = next_to_hand_out_++;
    if (handed_out_[number]) continue;
    handed_out_[number] = 1;
    asked.push_back({number, UnitPosition(points_.PositionOf(number), tree_.dimension()),
                     points_.IsProbe(number)});
  }
  return asked;
}

void MapSampling::State::GoOn() {
  while (!done_ && points_.waiting() == 0) {
    if (!is_measured_) MeasureRound();
    if (!awaited_.empty()) return;
    CompleteRound();
    done_ = !StartRound();
  }
  if (done_ && options_.basis == Basis::kCubic) MeasureSmooth();
}

void MapSampling::State::MeasureRound() {
  std::set<int> affected(changed_.begin(), changed_.end());
  for (const int element : changed_) {
    const std::vector<int> near = tree_.Neighbours(element);
    affected.insert(near.begin(), near.end());
  }
  for (const int element : affected) {
    if (tree_.IsElement(element)) Measure(element);
  }
  is_measured_ = true;
}

void MapSampling::State::CompleteRound() {
  changed_.clear();
  stated_.clear();
  is_measured_ = false;
  ++rounds_;
  complete_splits_ = tree_.history().size();
}

void MapSampling::State::Measure(int element) {
  using PointState = KnownPoints::State;
  KeepStated(element);
  Measured& measured = measured_[element];
  bool some_good = false;
  measured.has_failed = false;
  const auto look_at = [&](int number) {
    const bool failed = points_.StateOf(number) == PointState::kFailed;
    measured.has_failed = measured.has_failed || failed;
    some_good = some_good || !failed;
  };
  for (const int sample : tree_.ElementSamples(element)) look_at(sample_points_[sample]);
  auto& probes = measured.probes;
  probes.erase(std::remove_if(probes.begin(), probes.end(),
                              [&](int number) {
                                return tree_.elements().FindSample(points_.PositionOf(number)) >= 0;
                              }),
               probes.end());
  for (const int number : probes) look_at(number);
  measured.all_failed = !some_good;
  std::vector<PointWeights> weights;
  for (std::size_t n = 0; n < probes.size() && !measured.has_failed; ++n) {
    weights.push_back(
        tree_.Weights(UnitPosition(points_.PositionOf(probes[n]), tree_.dimension())));
    weights.back().gradients.resize(0, 0);
  }
  MeasureOutputs(measured, weights);
  if (options_.errors_from_outside) AwaitError(element, std::move(weights));
}

void MapSampling::State::MeasureOutputs(Measured& measured,
                                        const std::vector<PointWeights>& weights) {
  measured.differences.resize(outputs_, static_cast<Eigen::Index>(weights.size()));
  measured.errors = Eigen::VectorXd::Zero(outputs_);
  for (std::size_t n = 0; n < weights.size(); ++n) {
    Eigen::VectorXd difference = -points_.ValuesOf(measured.probes[n]);
    for (std::size_t k = 0; k < weights[n].samples.size(); ++k) {
      difference += weights[n].weights[static_cast<Eigen::Index>(k)] *
                    points_.ValuesOf(sample_points_[weights[n].samples[k]]);
    }
    measured.differences.col(static_cast<Eigen::Index>(n)) = difference.cwiseAbs();
    measured.errors = measured.errors.cwiseMax(difference.cwiseAbs());
  }
}

// Awaits the error of an element unless it interpolates what it did when it was told last.
void MapSampling::State::AwaitError(int element, std::vector<PointWeights> weights) {
  Measured& measured = measured_[element];
  const std::size_t samples = tree_.ElementSamples(element).size();
  const bool same = measured.samples == samples && measured.weights.size() == weights.size() &&
                    std::equal(weights.begin(), weights.end(), measured.weights.begin(), IsSame);
  measured.weights = std::move(weights);
  measured.samples = samples;
  if (measured.has_failed) {
    measured.outside = {};
  } else if (!same) {
    awaited_.insert(element);
  }
}

void MapSampling::State::TellError(int element, const OutsideError& error) {
  KeepStated(element);
  measured_[element].outside = error;
  awaited_.erase(element);
  told_errors_.emplace_back(element, error);
  if (awaited_.empty()) GoOn();
}

// Errors come one by one while the map is still that of the last complete round.
void MapSampling::State::KeepStated(int element) {
  if (!options_.errors_from_outside || rounds_ == 0) return;
  if (element > 2 * static_cast<int>(complete_splits_)) return;  // it has come with this round
  stated_.try_emplace(element, Stated{measured_[element].errors, measured_[element].cut_off()});
}

MapSampling::State::Stated MapSampling::State::StatedOf(int element) const {
  const auto kept = stated_.find(element);
  if (kept != stated_.end()) return kept->second;
  return {measured_[element].errors, measured_[element].cut_off()};
}

Eigen::VectorXd MapSampling::State::Scale() const {
  Eigen::VectorXd scale = points_.Range();
  for (int o = 0; o < outputs_ && !options_.scale.empty(); ++o) {
    if (options_.scale[o] > 0) scale[o] = options_.scale[o];
  }
  return scale;
}

double MapSampling::State::ErrorOfOutputs(const Measured& measured,
                                          const Eigen::VectorXd& scale) const {
  return RelativeError(measured.errors, options_.noise_floor, scale);
}

// Of all that is interpolated over an element that is not cut off.
double MapSampling::State::ErrorOf(const Measured& measured, const Eigen::VectorXd& scale) const {
  const double of_outputs = ErrorOfOutputs(measured, scale);
  return measured.outside.failed ? of_outputs : std::max(of_outputs, measured.outside.error);
}

// Whether an element is to be split because it fails, so that less of the map does.
bool MapSampling::State::MayShrink(int element) const {
  const Measured& measured = measured_[element];
  const bool fails_in_part = measured.cut_off() ? !measured.all_failed : measured.outside.failed;
  return fails_in_part && tree_.elements().LeastDepthOf(element) < options_.cut_off_depth &&
         shrinking_asked_ < kShrinkingShare * options_.budget;
}

std::vector<MapSampling::State::Candidate> MapSampling::State::Candidates() const {
  const Eigen::VectorXd scale = Scale();
  std::vector<Candidate> candidates;
  for (const int element : tree_.Elements()) {
    const Measured& measured = measured_[element];
    int depth = 0;
    for (int d = 0; d < tree_.dimension(); ++d) depth += tree_.DepthOf(element, d);
    // Where no direction is left that would make small what fails, values count.
    const bool shrinks =
        MayShrink(element) && DirectionFor({.element = element, .shrinks = true}) >= 0;
    double error = 1;
    if (!shrinks) {
      if (measured.cut_off() || (measured.outside.failed && outputs_ == 0)) continue;
      error = ErrorOf(measured, scale);
      const bool good = error <= options_.tolerance || smooth_enough_;
      if (good && depth >= kLeastDepth) continue;
    }
    candidates.push_back({error * std::exp2(-kSizePower * depth), element, shrinks});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.priority > b.priority; });
  return candidates;
}

// Splits until the round asks for enough points. Returns whether anything was split.
bool MapSampling::State::StartRound() {
  if (options_.basis == Basis::kCubic && points_.count() >= next_smooth_) {
    next_smooth_ = points_.count() + points_.count() / 2;
    MeasureSmooth();
  }
  const int before = points_.count();
  double first_priority = 0;
  for (const Candidate& candidate : Candidates()) {
    if (candidate.priority < kRoundShare * first_priority) break;
    const int direction = DirectionFor(candidate);
    if (!SplitElement(candidate, direction)) continue;
    first_priority = std::max(first_priority, candidate.priority);
    if (points_.count() - before >= options_.round_points) break;
  }
  return !changed_.empty();
}

std::vector<int> MapSampling::State::PointsAround(int element) const {
  std::set<int> found;
  std::vector<int> elements = tree_.Neighbours(element);
  elements.push_back(element);
  for (const int near : elements) {
    for (const int sample : tree_.ElementSamples(near)) found.insert(sample_points_[sample]);
    found.insert(measured_[near].probes.begin(), measured_[near].probes.end());
  }
  std::vector<int> good;
  for (const int number : found) {
    if (points_.StateOf(number) == KnownPoints::State::kGood) good.push_back(number);
  }
  return good;
}

// How much speaks for a split along each direction; zeros where nothing is known.
Eigen::VectorXd MapSampling::State::DirectionScores(const Candidate& candidate) const {
  const int dimension = tree_.dimension(), element = candidate.element;
  const Measured& measured = measured_[element];
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(dimension);
  if (measured.has_failed) return none;
  const Eigen::VectorXd scale = Scale();
  const bool is_of_outside = measured.outside.failed
                                 ? candidate.shrinks
                                 : measured.outside.error >= ErrorOfOutputs(measured, scale);
  if (options_.errors_from_outside && is_of_outside) {
    return measured.outside.bending.size() == 0 ? none : measured.outside.bending;
  }
  const std::vector<int> around = PointsAround(element);
  Eigen::MatrixXd places(dimension, around.size()), values(outputs_, around.size());
  for (std::size_t n = 0; n < around.size(); ++n) {
    const auto column = static_cast<Eigen::Index>(n);
    places.col(column) = UnitPosition(points_.PositionOf(around[n]), dimension);
    values.col(column) = points_.ValuesOf(around[n]);
  }
  Eigen::VectorXd score = none;
  const Eigen::MatrixXd bending = BendingOver(tree_.BoxOf(element), places, values);
  for (int o = 0; o < outputs_; ++o) {
    const double floor = options_.noise_floor.empty() ? 0 : options_.noise_floor[o];
    if (scale[o] <= 0 || measured.errors[o] <= floor) continue;
    score = score.cwiseMax(bending.col(o) / scale[o]);
  }
  return score;
}

int MapSampling::State::DirectionFor(const Candidate& candidate) const {
  const int element = candidate.element;
  const Eigen::VectorXd score = DirectionScores(candidate);
  const bool only_named = candidate.shrinks && (score.array() > 0).any();
  int best = -1;
  for (int d = 0; d < tree_.dimension(); ++d) {
    if (!tree_.CanSplit(element, d)) continue;
    if (candidate.shrinks && tree_.DepthOf(element, d) >= options_.cut_off_depth) continue;
    if (only_named && score[d] == 0) continue;
    const bool longer = best >= 0 && tree_.DepthOf(element, d) < tree_.DepthOf(element, best);
    if (best < 0 || score[d] > score[best] || (score[d] == score[best] && longer)) best = d;
  }
  return best < 0 ? -1 : tree_.DirectionBefore(element, best);
}

// How many points a split asks for that are not known.
int MapSampling::State::CostOf(int element, int direction) const {
  int cost = 0;
  for (const LatticePoint& position : tree_.NewSamples(element, direction)) {
    cost += points_.IsKnown(position) ? 0 : 1;
  }
  LatticeBox halves[2] = {tree_.LatticeBoxOf(element), tree_.LatticeBoxOf(element)};
  halves[0].high[direction] = CentreOf(halves[0], tree_.dimension())[direction];
  halves[1].low[direction] = halves[0].high[direction];
  for (const LatticeBox& half : halves) {
    for (const LatticePoint& position : MissingProbes(half, measured_[element].probes)) {
      cost += points_.IsKnown(position) ? 0 : 1;
    }
  }
  return cost;
}

bool MapSampling::State::SplitElement(const Candidate& candidate, int direction) {
  const int element = candidate.element;
  if (direction < 0) return false;
  if (points_.count() + CostOf(element, direction) > options_.budget) return false;
  const int before = points_.count();
  const absl::StatusOr<std::vector<int>> samples = tree_.Split(element, direction);
  if (!samples.ok()) return false;
  WantSamples(*samples);
  measured_.resize(tree_.elements().node_count());
  const int first = tree_.elements().node_count() - 2;
  for (const int child : {first, first + 1}) {
    for (const int number : measured_[element].probes) {
      if (InClosedBox(tree_.LatticeBoxOf(child), points_.PositionOf(number), tree_.dimension())) {
        measured_[child].probes.push_back(number);
      }
    }
    PlaceProbes(child);
    changed_.push_back(child);
  }
  if (candidate.shrinks) shrinking_asked_ += points_.count() - before;
  return true;
}

}  // namespace mortise::maps
