#include "common/maps/map_sampling.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/maps/sampling_state.h"

namespace mortise::maps {
namespace {

absl::Status CheckPerOutput(const std::vector<double>& numbers, int outputs, const char* field) {
  if (!numbers.empty() && static_cast<int>(numbers.size()) != outputs) {
    return InvalidField(field,
                        absl::StrCat("has ", numbers.size(), " numbers for ", outputs, " outputs"));
  }
  for (const double number : numbers) {
    if (!std::isfinite(number) || number < 0)
      return InvalidField(field, "is negative or not finite");
  }
  return absl::OkStatus();
}

absl::Status CheckOptions(int dimension, int outputs, const MapSamplingOptions& options) {
  if (outputs < (options.errors_from_outside ? 0 : 1)) {
    return InvalidField("outputs", "is less than 1");
  }
  if (options.errors_from_outside && options.basis != Basis::kLinear) {
    return InvalidField("options.errors_from_outside", "needs the linear basis");
  }
  const int least = (1 << dimension) + 2;
  if (options.budget < least) {
    return InvalidField("options.budget",
                        absl::StrCat("is ", options.budget, ", but the corners of a box of ",
                                     dimension, " directions and two probes are ", least));
  }
  if (!std::isfinite(options.tolerance) || options.tolerance < 0) {
    return InvalidField("options.tolerance", "is negative or not finite");
  }
  if (options.round_points < 1) return InvalidField("options.round_points", "is less than 1");
  if (options.cut_off_depth < 0) return InvalidField("options.cut_off_depth", "is negative");
  if (absl::Status status = CheckPerOutput(options.noise_floor, outputs, "options.noise_floor");
      !status.ok()) {
    return status;
  }
  return CheckPerOutput(options.scale, outputs, "options.scale");
}

absl::Status CheckCheckpoint(const MapSamplingCheckpoint& checkpoint, int outputs) {
  const std::size_t count = checkpoint.numbers.size();
  if (checkpoint.failures.size() != count ||
      checkpoint.values.cols() != static_cast<Eigen::Index>(count) ||
      (count > 0 && checkpoint.values.rows() != outputs)) {
    return InvalidField("checkpoint", "has arrays of other sizes than its count of points");
  }
  return absl::OkStatus();
}

}  // namespace

MapSampling::MapSampling(std::unique_ptr<State> state) : state_(std::move(state)) {}
double RelativeError(const Eigen::VectorXd& errors, const std::vector<double>& noise_floor,
                     const Eigen::VectorXd& scale) {
  double largest = 0;
  for (Eigen::Index o = 0; o < errors.size(); ++o) {
    const double floor = noise_floor.empty() ? 0 : noise_floor[static_cast<std::size_t>(o)];
    const double beyond = errors[o] - floor;
    if (beyond > 0 && scale[o] > 0) largest = std::max(largest, beyond / scale[o]);
  }
  return largest;
}

MapSampling::MapSampling(MapSampling&&) noexcept = default;
MapSampling& MapSampling::operator=(MapSampling&&) noexcept = default;
MapSampling::~MapSampling() = default;

absl::StatusOr<MapSampling> MapSampling::Create(int dimension, int outputs,
                                                const MapSamplingOptions& options) {
  // Where to split does not depend on the basis, but whether there is such a map does.
  absl::StatusOr<RefinementTree> tree =
      RefinementTree::Create(dimension, options.basis, options.refinement);
  if (tree.ok() && options.basis != Basis::kLinear) {
    tree = RefinementTree::Create(dimension, Basis::kLinear, options.refinement);
  }
  if (!tree.ok()) return tree.status();
  if (absl::Status status = CheckOptions(dimension, outputs, options); !status.ok()) return status;
  return MapSampling(std::make_unique<State>(*std::move(tree), outputs, options));
}

absl::StatusOr<MapSampling> MapSampling::Restore(int dimension, int outputs,
                                                 const MapSamplingOptions& options,
                                                 const MapSamplingCheckpoint& checkpoint) {
  absl::StatusOr<MapSampling> sampling = Create(dimension, outputs, options);
  if (!sampling.ok()) return sampling.status();
  if (absl::Status status = CheckCheckpoint(checkpoint, outputs); !status.ok()) return status;
  // Points are numbered in the order in which they become wanted, so that going up the numbers
  // completes one round after the other. Between rounds come the errors that ended the last one.
  std::map<int, int> order;
  for (std::size_t n = 0; n < checkpoint.numbers.size(); ++n) {
    if (!order.emplace(checkpoint.numbers[n], static_cast<int>(n)).second) {
      return InvalidField(absl::StrCat("checkpoint.numbers[", n, "]"), "is there twice");
    }
  }
  std::size_t next_error = 0;
  const auto tell_errors = [&]() -> absl::Status {
    while (!sampling->AwaitedErrors().empty() && next_error < checkpoint.errors.size()) {
      const auto& [element, error] = checkpoint.errors[next_error++];
      MORTISE_RETURN_IF_ERROR(sampling->TellError(element, error));
    }
    return absl::OkStatus();
  };
  for (const auto& [number, n] : order) {
    MORTISE_RETURN_IF_ERROR(sampling->RestorePoint(checkpoint, n));
    MORTISE_RETURN_IF_ERROR(tell_errors());
  }
  if (next_error < checkpoint.errors.size()) {
    return InvalidField(absl::StrCat("checkpoint.errors[", next_error, "]"),
                        "was never awaited with these arguments");
  }
  return sampling;
}

absl::Status MapSampling::RestorePoint(const MapSamplingCheckpoint& checkpoint, int n) {
  const int number = checkpoint.numbers[n];
  if (number < 0 || number >= state_->points().count()) {
    return InvalidField(absl::StrCat("checkpoint.numbers[", n, "]"),
                        "was never asked with these arguments");
  }
  state_->MarkAsked(number);
  const std::string& failure = checkpoint.failures[n];
  return failure.empty() ? Tell(number, checkpoint.values.col(n))
                         : TellFailure(number, absl::UnknownError(failure));
}

absl::Status MapSampling::SetNoiseFloor(std::vector<double> noise_floor) {
  MORTISE_RETURN_IF_ERROR(CheckPerOutput(noise_floor, state_->outputs(), "noise_floor"));
  if (state_->points().waiting() < state_->points().count()) {
    return PreconditionFailed("SAMPLING_HAS_BEGUN", "points have been told already");
  }
  state_->SetNoiseFloor(std::move(noise_floor));
  return absl::OkStatus();
}

std::vector<AskedPoint> MapSampling::Ask(int most) { return state_->Ask(most); }

absl::Status MapSampling::Tell(int number, const Eigen::Ref<const Eigen::VectorXd>& values) {
  if (values.size() != state_->outputs()) {
    return InvalidField("values", absl::StrCat("has ", values.size(), " numbers for ",
                                               state_->outputs(), " outputs"));
  }
  if (!values.allFinite()) {
    return TellFailure(number, absl::InvalidArgumentError("a value is not finite"));
  }
  if (absl::Status status = CheckWaiting(number); !status.ok()) return status;
  state_->points().SetValues(number, values);
  state_->GoOn();
  return absl::OkStatus();
}

absl::Status MapSampling::TellFailure(int number, const absl::Status& reason) {
  if (absl::Status status = CheckWaiting(number); !status.ok()) return status;
  const std::string message(reason.message());
  state_->points().SetFailure(number, message.empty() ? reason.ToString() : message);
  state_->GoOn();
  return absl::OkStatus();
}

std::vector<int> MapSampling::AwaitedErrors() const {
  return {state_->awaited().begin(), state_->awaited().end()};
}

absl::Status MapSampling::TellError(int element, const OutsideError& error) {
  if (state_->awaited().empty()) return InvalidField("element", "no error is awaited");
  if (!tree().IsElement(element) || state_->HasFailedPoint(element)) {
    return InvalidField("element", absl::StrCat(element, " is none that has an error"));
  }
  if (!std::isfinite(error.error) || error.error < 0) {
    return InvalidField("error.error", "is negative or not finite");
  }
  if (error.bending.size() != 0 && error.bending.size() != tree().dimension()) {
    return InvalidField("error.bending", absl::StrCat("has ", error.bending.size(), " numbers for ",
                                                      tree().dimension(), " directions"));
  }
  if (!error.bending.allFinite() || (error.bending.array() < 0).any()) {
    return InvalidField("error.bending", "holds numbers that are negative or not finite");
  }
  state_->TellError(element, error);
  return absl::OkStatus();
}

absl::Status MapSampling::CheckWaiting(int number) const {
  const KnownPoints& points = state_->points();
  if (number < 0 || number >= points.count() || !state_->WasAsked(number)) {
    return InvalidField("number", absl::StrCat("point ", number, " was never asked"));
  }
  if (points.StateOf(number) != KnownPoints::State::kWaiting) {
    return InvalidField("number", absl::StrCat("point ", number, " has been told already"));
  }
  return absl::OkStatus();
}

bool MapSampling::Done() const { return state_->done(); }

MapSamplingProgress MapSampling::Progress() const {
  const KnownPoints& points = state_->points();
  MapSamplingProgress progress;
  progress.asked = points.count();
  progress.told = points.count() - points.waiting();
  progress.failed = points.failed();
  progress.samples = state_->tree().sample_count();
  progress.elements = state_->tree().element_count();
  progress.cut_off = state_->CutOffCount();
  progress.lacking_outside = state_->LackingOutsideCount();
  progress.awaited = static_cast<int>(state_->awaited().size());
  progress.errors = state_->Errors();
  progress.outside_error = state_->LargestOutsideError();
  return progress;
}

MapSamplingCheckpoint MapSampling::Checkpoint() const {
  const KnownPoints& points = state_->points();
  MapSamplingCheckpoint checkpoint;
  checkpoint.values = Eigen::MatrixXd::Zero(state_->outputs(), points.count() - points.waiting());
  for (int number = 0; number < points.count(); ++number) {
    if (points.StateOf(number) == KnownPoints::State::kWaiting) continue;
    const auto n = static_cast<Eigen::Index>(checkpoint.numbers.size());
    const auto reason = points.reasons().find(number);
    checkpoint.numbers.push_back(number);
    checkpoint.failures.push_back(reason == points.reasons().end() ? "" : reason->second);
    checkpoint.values.col(n) = points.ValuesOf(number);
  }
  checkpoint.errors = state_->told_errors();
  return checkpoint;
}

std::vector<std::pair<Eigen::VectorXd, std::string>> MapSampling::Failures() const {
  std::vector<std::pair<Eigen::VectorXd, std::string>> failures;
  for (const auto& [number, reason] : state_->points().reasons()) {
    failures.emplace_back(PositionOf(number), reason);
  }
  return failures;
}

int MapSampling::PointOfSample(int sample) const { return state_->PointOfSample(sample); }

const std::vector<int>& MapSampling::ProbesOf(int element) const {
  return state_->ProbesOf(element);
}

std::vector<int> MapSampling::ElementsAround(int number) const {
  const LatticePoint& position = state_->points().PositionOf(number);
  return tree().elements().Touching({position, position});
}

Eigen::VectorXd MapSampling::PositionOf(int number) const {
  return UnitPosition(state_->points().PositionOf(number), tree().dimension());
}

bool MapSampling::HasFailed(int number) const {
  return state_->points().StateOf(number) == KnownPoints::State::kFailed;
}

bool MapSampling::IsCutOff(int element) const { return state_->IsCutOff(element); }

const RefinementTree& MapSampling::tree() const { return state_->tree(); }

absl::StatusOr<MapContent> MapSampling::Content() const {
  if (!state_->HasContent()) {
    return PreconditionFailed("MAP_NOT_SAMPLED", "the corners of the map have not all been told");
  }
  return state_->Content();
}

}  // namespace mortise::maps
