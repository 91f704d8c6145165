// Adaptive sampling of a function over the unit box (thesis 6.4.2), as a conversation: Ask says
// where to evaluate, Tell takes the answers, in any order and batch. No threads, no clock: the same
// answers give the same map bit for bit, whatever their order.
//
// How it goes. Rounds. A round asks for the corners that are missing (samples) and, in each new
// element, for points to measure the error at (probes): its centre and one more, seeded, a quarter
// of the edges away from it, which an element may have from the one that it is a part of. The error
// of an element is the largest difference between map and truth at its probes, less the noise
// floor, over the output's range. When all points of a round have been told, the elements with the
// largest error × size^(1/2), where size is the volume, are split, each along the direction in
// which a local model of all that is known around it bends most over the element. Errors of
// neighbours are measured anew from probes that they have, at no cost. Each point asked counts in
// the budget; none is asked twice.
//
// Where points fail: an element that has a failed corner, or a failed probe, is cut off. It is
// split in its longest direction, so that what is cut off becomes small, down to `cut_off_depth`
// splits along each direction; the rest goes on.
//
// Errors told from outside. Who interpolates more than the outputs with the map's weights, such as
// shapes and fields, measures the errors of that itself: when all points of a round have been told,
// AwaitedErrors says of which elements, and nothing else is asked until TellError has come for all.
// The larger of both errors of an element counts, and decides along which direction it is split. An
// element of which it is told that nothing can be interpolated but the outputs keeps these: it is
// split likewise, so that such parts become small, and then where its outputs are off.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/maps/basis.h"
#include "common/maps/interpolation_map.h"
#include "common/maps/refinement_tree.h"

namespace mortise::maps {

// To be raised with every change by which the same answers and errors lead to other points, or to
// the same in another order: what is kept by the numbers of points holds for one version alone.
inline constexpr int kSamplingVersion = 1;

struct MapSamplingOptions {
  Basis basis = Basis::kLinear;
  RefinementOptions refinement{};
  // The most points that are asked, samples and probes together. At least 2^K + 2.
  int budget = 200;
  // Sampling ends when no element's error, over the output's range, is larger.
  double tolerance = 0;
  // For each output what it scatters by although nothing changes, in its own unit; empty: zero. A
  // difference below is no error.
  std::vector<double> noise_floor{};
  // For each output what its errors are divided by; empty, or 0 for an output: the difference
  // between the largest and the smallest value known.
  std::vector<double> scale{};
  // Where the second probe of an element lies.
  std::uint64_t seed = 1;
  // A round goes on splitting until it asks for as many points. More keeps more workers busy; fewer
  // choose better.
  int round_points = 8;
  // The most splits along each direction of an element that is cut off, or for the sake of what
  // fails from outside.
  int cut_off_depth = 3;
  // Whether errors come by TellError, too. Then there may be no outputs at all. It needs the linear
  // basis.
  bool errors_from_outside = false;
};

// A point to evaluate.
struct AskedPoint {
  int number = 0;            // for Tell: 0, 1, …
  Eigen::VectorXd position;  // in the unit box
  bool probe = false;        // asked for the error alone; it may become a sample later
};

// How far what is interpolated beside the outputs is off in an element.
struct OutsideError {
  // The largest at the element's probes, over the range of what is interpolated and beyond its
  // noise floor: comparable with the tolerance.
  double error = 0;
  // K: how much of it comes along each direction. Only proportions count; empty: not known.
  Eigen::VectorXd bending{};
  // Whether what comes from outside cannot be interpolated over the element at all, as shapes of
  // different topology cannot. It is split along the directions that `bending` names alone then,
  // its longest first where there is none, as far as what is cut off; its outputs are interpolated
  // as everywhere.
  bool failed = false;
};

// Differences between map and truth at all present probes, for each output in its own unit. No
// probe is a sample, so that this is a cross-validation.
struct MapErrors {
  Eigen::VectorXd largest;
  Eigen::VectorXd mean;
  Eigen::VectorXd
      range;       // what they may be divided by: the scale of the options, else the range known
  int probes = 0;  // how many differences there are
};

// The largest of the outputs' errors, each less its noise floor (none where the list is empty) and
// over its scale; outputs of scale 0 have none.
double RelativeError(const Eigen::VectorXd& errors, const std::vector<double>& noise_floor,
                     const Eigen::VectorXd& scale);

struct MapSamplingProgress {
  int asked = 0;  // points handed out or to be handed out in this round and before
  int told = 0;
  int failed = 0;  // among those told
  int samples = 0;
  int elements = 0;
  int cut_off = 0;  // elements
  // Elements with outputs alone: what comes from outside was told to have failed there.
  int lacking_outside = 0;
  int awaited = 0;  // elements whose error is to be told from outside
  MapErrors errors;
  double outside_error = 0;  // the largest of the elements that have one
};

// Everything that was told. With the same dimension, outputs and options it says all: restoring
// asks nothing that was told.
struct MapSamplingCheckpoint {
  std::vector<int> numbers;           // of the points told
  std::vector<std::string> failures;  // for each, why it failed; empty where it did not
  Eigen::MatrixXd values;             // outputs × told; zero where it failed
  // What TellError was told, in that order, by element.
  std::vector<std::pair<int, OutsideError>> errors;
};

class MapSampling {
 public:
  // INVALID_ARGUMENT, field `dimension`, `outputs` or `options.…`.
  // `outputs` may be 0 where errors come from outside.
  static absl::StatusOr<MapSampling> Create(int dimension, int outputs,
                                            const MapSamplingOptions& options);
  // Goes on where the checkpoint of another of the same arguments was taken. Points that were asked
  // and not told are asked again. INVALID_ARGUMENT, field `checkpoint.…`: not of these arguments.
  static absl::StatusOr<MapSampling> Restore(int dimension, int outputs,
                                             const MapSamplingOptions& options,
                                             const MapSamplingCheckpoint& checkpoint);

  MapSampling(MapSampling&&) noexcept;
  MapSampling& operator=(MapSampling&&) noexcept;
  ~MapSampling();

  // Sets the noise floors of the options before anything has been told: they may come of the first
  // evaluations. INVALID_ARGUMENT, field `noise_floor`; FAILED_PRECONDITION, SAMPLING_HAS_BEGUN.
  absl::Status SetNoiseFloor(std::vector<double> noise_floor);

  // At most `most` points that have not been handed out. Empty while the round waits for answers,
  // and when all is done.
  std::vector<AskedPoint> Ask(int most);
  // The values of a point, one for each output. A value that is not finite counts as a failure.
  // INVALID_ARGUMENT, field `number` or `values`: never asked, told already, or another count.
  absl::Status Tell(int number, const Eigen::Ref<const Eigen::VectorXd>& values);
  // Why a point could not be evaluated; `reason` is not OK.
  absl::Status TellFailure(int number, const absl::Status& reason);

  // The elements whose error is wanted from outside, ascending: those that are new and those that
  // interpolate other samples than before, or with other weights at their probes. Empty while
  // points are waited for, and without `errors_from_outside`.
  std::vector<int> AwaitedErrors() const;
  // The error of an element. While any is awaited, elements that are not may be told anew, because
  // what their error is relative to has changed: the last awaited one ends the round.
  // INVALID_ARGUMENT, field `element`, no element that is not cut off for failed points, or none is
  // awaited; `error.…`, negative, not finite or of another dimension.
  absl::Status TellError(int element, const OutsideError& error);

  // Whether budget or tolerance is reached and nothing is waited for.
  bool Done() const;
  MapSamplingProgress Progress() const;
  MapSamplingCheckpoint Checkpoint() const;
  // The failures, by number of the point: where and why.
  std::vector<std::pair<Eigen::VectorXd, std::string>> Failures() const;

  // The number of the point that a sample of tree() is.
  int PointOfSample(int sample) const;
  // The points that an element's error is measured at: they lie in it and are no samples.
  const std::vector<int>& ProbesOf(int element) const;
  // The elements that a point lies in or touches, ascending.
  std::vector<int> ElementsAround(int number) const;
  // Where a point is, in the unit box.
  Eigen::VectorXd PositionOf(int number) const;
  // Whether a point has been told as a failure.
  bool HasFailed(int number) const;
  // Whether an element of tree() has a point that failed.
  bool IsCutOff(int element) const;

  // Elements and samples of the present round, with the linear basis: its errors choose where to
  // split for a cubic map, too, whose own errors are measured whenever half as many points again
  // are known.
  const RefinementTree& tree() const;
  // The map as it is after the last complete round: all its points and errors have been told.
  // FAILED_PRECONDITION, reason MAP_NOT_SAMPLED, before the first.
  absl::StatusOr<MapContent> Content() const;

 private:
  class State;
  explicit MapSampling(std::unique_ptr<State> state);
  absl::Status CheckWaiting(int number) const;
  absl::Status RestorePoint(const MapSamplingCheckpoint& checkpoint, int n);
  std::unique_ptr<State> state_;
};

}  // namespace mortise::maps
