#include "services/interpolator/building/map_building.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/mapping/guarded.h"

namespace mortise::interpolator {
namespace {

constexpr std::chrono::milliseconds kCancelPoll{100};

using Clock = std::chrono::steady_clock;

}  // namespace

const char* StopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "CONVERGED";
    case StopReason::kBudget:
      return "BUDGET";
    case StopReason::kTime:
      return "TIME";
    case StopReason::kCancelled:
      return "CANCELLED";
  }
  return "";
}

absl::StatusOr<std::unique_ptr<MapBuilding>> MapBuilding::Create(const MapPlan& plan,
                                                                 const BuildOptions& options) {
  std::unique_ptr<MapBuilding> building(new MapBuilding(plan, options));
  building->noise_floor_ = options.sampling.noise_floor;
  building->awaits_noise_ = options.noise.has_value();
  const auto structures = static_cast<int>(plan.structures.cols());
  const int evaluations = plan.evaluations - (options.noise ? 1 : 0);
  for (int s = 0; s < structures; ++s) {
    maps::MapSamplingOptions sampling = options.sampling;
    sampling.errors_from_outside = options.shapes.has_value();
    // What does not divide evenly goes to the first ones.
    sampling.budget = evaluations / structures + (s < evaluations % structures ? 1 : 0);
    MORTISE_ASSIGN_OR_RETURN(
        maps::MapSampling created,
        maps::MapSampling::Create(static_cast<int>(plan.NumberParameters().size()),
                                  static_cast<int>(plan.metrics.size()), sampling));
    building->structures_.push_back(std::make_unique<maps::MapSampling>(std::move(created)));
  }
  if (options.shapes) {
    building->shapes_ = std::make_unique<ShapeBuilding>(
        *options.shapes, building->structures_,
        [mailbox = &building->mailbox_](Event event) { mailbox->Put(std::move(event)); });
  }
  return building;
}

absl::Status MapBuilding::Run(const KnownAnswers& known, KnownShapes known_shapes) {
  ThreadPool lanes(std::max(1, options_.lanes));
  if (shapes_) shapes_->SetKnown(std::move(known_shapes));
  const absl::Status status = RunToItsEnd(known, lanes);
  if (!status.ok()) {
    if (options_.interrupt) options_.interrupt();
    KeepWhatIsUnderWay();
  }
  return status;
}

absl::Status MapBuilding::RunToItsEnd(const KnownAnswers& known, ThreadPool& lanes) {
  if (awaits_noise_ && options_.noise->known) {
    MORTISE_RETURN_IF_ERROR(SettleNoise(*options_.noise->known));
  }
  // First, so that a build that is stopped at once has what is known of it.
  if (!known.empty()) MORTISE_RETURN_IF_ERROR(Replay(known));
  Clock::time_point answered = Clock::now(), told = answered;
  while (true) {
    if (StopWhenAsked()) {
      if (options_.interrupt) options_.interrupt();
      if (shapes_) shapes_->Stop();
      // Nobody asks for it any more: what is known makes a map without it.
      if (awaits_noise_ && !has_asked_for_noise_) MORTISE_RETURN_IF_ERROR(SettleNoise({}));
    }
    if (shapes_) shapes_->Release();
    MORTISE_RETURN_IF_ERROR(FillLanes(known, lanes));
    if (IsIdle()) return absl::OkStatus();
    const bool is_asking = under_way_ > 0;
    const std::optional<Event> event = mailbox_.Take(kCancelPoll);
    const Clock::time_point now = Clock::now();
    if (event) MORTISE_RETURN_IF_ERROR(Happen(*event));
    if (event || !is_asking) {
      answered = told = now;
    } else if (options_.waiting && !is_stopped_ && now - told >= options_.quiet) {
      told = now;
      options_.waiting(std::chrono::duration_cast<std::chrono::seconds>(now - answered));
    }
  }
}

// With all else that has come, so that it is kept together.
absl::Status MapBuilding::Happen(const Event& first) {
  MORTISE_RETURN_IF_ERROR(first());
  while (const std::optional<Event> next = mailbox_.Take(std::chrono::milliseconds(0))) {
    MORTISE_RETURN_IF_ERROR((*next)());
  }
  if (shapes_) MORTISE_RETURN_IF_ERROR(is_stopped_ ? shapes_->Keep() : shapes_->GoOn());
  TellProgress();
  return absl::OkStatus();
}

// Whether it is stopped from now on.
bool MapBuilding::StopWhenAsked() {
  if (is_stopped_) return false;
  if (options_.cancelled && options_.cancelled()) {
    stopped_by_ = StopReason::kCancelled;
    is_stopped_ = true;
  } else if (options_.is_out_of_time && options_.is_out_of_time() && HasMap()) {
    stopped_by_ = StopReason::kTime;
    is_stopped_ = true;
  }
  return is_stopped_;
}

// Whether there is a map of each structure by now.
bool MapBuilding::HasMap() const {
  return std::ranges::all_of(structures_,
                             [](const auto& structure) { return structure->Content().ok(); });
}

// Tells all that is known, round by round. What is asked meanwhile and not known waits to be
// evaluated, and what is not known of shapes to be found out.
absl::Status MapBuilding::Replay(const KnownAnswers& known) {
  if (shapes_) shapes_->Hold();
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<Asked> batch, NextBatch(known));
    if (!batch.empty()) {
      waiting_.push_back(std::move(batch));
      continue;
    }
    if (shapes_ == nullptr || shapes_->IsHeldUp()) return absl::OkStatus();
    if (const std::optional<Event> event = mailbox_.Take(kCancelPoll)) {
      MORTISE_RETURN_IF_ERROR(Happen(*event));
    }
  }
}

absl::Status MapBuilding::FillLanes(const KnownAnswers& known, ThreadPool& lanes) {
  while (!is_stopped_ && under_way_ < std::max(1, options_.lanes)) {
    if (awaits_noise_ && middle_ && !has_asked_for_noise_) {
      AskForNoise(lanes);
      continue;
    }
    std::vector<Asked> batch;
    if (!waiting_.empty()) {
      batch = std::move(waiting_.front());
      waiting_.pop_front();
    } else {
      MORTISE_ASSIGN_OR_RETURN(batch, NextBatch(known));
    }
    if (batch.empty()) return absl::OkStatus();
    ++under_way_;
    lanes.Submit([this, batch = std::move(batch)] {
      mailbox_.Put([this, answered = Guarded([&] { return Evaluate(batch); })] {
        return Receive(answered);
      });
    });
  }
  return absl::OkStatus();
}

// Structures are asked in turn, so that each comes along.
absl::StatusOr<std::vector<MapBuilding::Asked>> MapBuilding::NextBatch(const KnownAnswers& known) {
  std::vector<Asked> batch;
  const int most = std::max(1, options_.batch_size);
  std::size_t without = 0;  // structures that had nothing to ask
  while (static_cast<int>(batch.size()) < most && without < structures_.size()) {
    const std::size_t structure = next_;
    next_ = (next_ + 1) % structures_.size();
    const auto asked = structures_[structure]->Ask(most - static_cast<int>(batch.size()));
    without = asked.empty() ? without + 1 : 0;
    for (const maps::AskedPoint& point : asked) {
      Asked each{{static_cast<int>(structure), point.number},
                 plan_.DesignAt(static_cast<Eigen::Index>(structure), point.position)};
      const DesignAnswer* const answer = FindAnswer(known, each.key);
      if (answer == nullptr) {
        batch.push_back(std::move(each));
      } else {
        MORTISE_RETURN_IF_ERROR(Tell(each, *answer));
      }
    }
  }
  return batch;
}

// Null where it is not known, or lacks the file that this map needs.
const DesignAnswer* MapBuilding::FindAnswer(const KnownAnswers& known, const DesignKey& key) const {
  const auto found = known.find(key);
  if (found == known.end()) return nullptr;
  const DesignAnswer& answer = found->second;
  return shapes_ && answer.status.ok() && answer.file.empty() ? nullptr : &answer;
}

absl::StatusOr<MapBuilding::Batch> MapBuilding::Evaluate(const std::vector<Asked>& asked) const {
  std::vector<Eigen::VectorXd> designs;
  for (const Asked& each : asked) designs.push_back(each.design);
  MORTISE_ASSIGN_OR_RETURN(std::vector<DesignAnswer> answers, options_.evaluate(designs));
  if (answers.size() != asked.size()) {
    return absl::InternalError(
        absl::StrCat("the evaluator answered ", answers.size(), " of ", asked.size(), " designs"));
  }
  Batch batch;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(DesignAnswer checked, Checked(std::move(answers[i])));
    batch.emplace_back(asked[i], std::move(checked));
  }
  return batch;
}

// An evaluator that gives no number, or no shape, has failed, whatever it says.
absl::StatusOr<DesignAnswer> MapBuilding::Checked(DesignAnswer answer) const {
  for (std::size_t i = 0; answer.status.ok() && i < plan_.metrics.size(); ++i) {
    if (std::isfinite(answer.values[static_cast<Eigen::Index>(i)])) continue;
    answer.status = WithDetail(
        absl::InternalError(absl::StrCat("the evaluator left out '", plan_.metrics[i].name,
                                         "', or gave a value that is not finite")),
        {"NOT_FINITE", ""});
  }
  if (!shapes_ || !answer.status.ok()) return answer;
  if (answer.file.empty()) {
    answer.status =
        WithDetail(absl::InternalError("the evaluator gave no shape"), {"FILE_MISSING", ""});
    return answer;
  }
  MORTISE_RETURN_IF_ERROR(shapes_->CheckDesign(answer.file, answer.status));
  return answer;
}

absl::Status MapBuilding::Receive(absl::StatusOr<Batch> batch) {
  --under_way_;
  // Of a call that was interrupted.
  if ((is_stopped_ || has_failed_) && !batch.ok()) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(batch.status());
  if (options_.keep) {
    KnownAnswers answers;
    for (const auto& [asked, answer] : *batch) answers[asked.key] = answer;
    MORTISE_RETURN_IF_ERROR(options_.keep(answers));
  }
  if (has_failed_) return absl::OkStatus();
  for (const auto& [asked, answer] : *batch) MORTISE_RETURN_IF_ERROR(Tell(asked, answer));
  return options_.judge ? options_.judge(Counts()) : absl::OkStatus();
}

// Errors are looked up in all elements, which takes time where there are many: a tenth of it all at
// the most.
void MapBuilding::TellProgress() {
  const Clock::time_point began = Clock::now();
  if (!options_.progress || began < next_progress_) return;
  options_.progress(progress());
  const Clock::time_point ended = Clock::now();
  next_progress_ = ended + 9 * (ended - began);
}

// What is held back counts already: whoever watches sees that designs are evaluated.
absl::Status MapBuilding::Tell(const Asked& asked, const DesignAnswer& answer) {
  ++evaluations_;
  if (!answer.status.ok()) {
    failures_.Add({DetailOf(answer.status).reason, answer.status.code(),
                   std::string(answer.status.message()), plan_.PointOf(asked.design)});
  }
  return awaits_noise_ ? HoldBack(asked, answer) : Use(asked, answer);
}

absl::Status MapBuilding::Use(const Asked& asked, const DesignAnswer& answer) {
  const auto structure = static_cast<std::size_t>(asked.key.structure);
  const absl::Status told =
      answer.status.ok()
          ? structures_[structure]->Tell(static_cast<int>(asked.key.number), answer.values)
          : structures_[structure]->TellFailure(static_cast<int>(asked.key.number), answer.status);
  if (!told.ok()) {
    return absl::DataLossError(
        absl::StrCat("the answers that were kept are of another map: ", told.message()));
  }
  if (!shapes_ || is_stopped_) return absl::OkStatus();
  return shapes_->Told(asked.key.structure, static_cast<int>(asked.key.number),
                       answer.status.ok() ? answer.file : "");
}

// Until the noise is known, by which it is decided where to go on. No more than the first round can
// come before.
absl::Status MapBuilding::HoldBack(const Asked& asked, const DesignAnswer& answer) {
  held_back_.emplace_back(asked, answer);
  const auto numbers = static_cast<Eigen::Index>(plan_.NumberParameters().size());
  const Eigen::VectorXd middle = plan_.DesignAt(0, Eigen::VectorXd::Constant(numbers, 0.5));
  if (asked.key.structure != 0 || asked.design != middle) return absl::OkStatus();
  middle_ = answer;
  // There is nothing to compare.
  return answer.status.ok() ? absl::OkStatus() : SettleNoise({});
}

void MapBuilding::AskForNoise(ThreadPool& lanes) {
  has_asked_for_noise_ = true;
  ++under_way_;
  lanes.Submit([this, one = *middle_] {
    mailbox_.Put([this, noise = Guarded([&] { return EstimateNoise(one); })] {
      return ReceiveNoise(noise);
    });
  });
}

absl::StatusOr<MeshNoise> MapBuilding::EstimateNoise(const DesignAnswer& one) const {
  const auto numbers = static_cast<Eigen::Index>(plan_.NumberParameters().size());
  MORTISE_ASSIGN_OR_RETURN(
      const DesignAnswer other,
      options_.noise->evaluate(plan_.DesignAt(0, Eigen::VectorXd::Constant(numbers, 0.5))));
  MORTISE_ASSIGN_OR_RETURN(
      MeshNoise noise,
      CompareMeshes(one, other, options_.shapes ? &*options_.shapes : nullptr, *options_.noise));
  noise.evaluations = 1;
  return noise;
}

absl::Status MapBuilding::ReceiveNoise(absl::StatusOr<MeshNoise> noise) {
  --under_way_;
  // After a failure elsewhere, too, and not what was interrupted.
  if (noise.ok() && options_.noise->keep) {
    MORTISE_RETURN_IF_ERROR(options_.noise->keep(*noise));
  }
  if (has_failed_) return absl::OkStatus();
  if (is_stopped_ && !noise.ok()) return SettleNoise({});
  MORTISE_RETURN_IF_ERROR(noise.status());
  MORTISE_RETURN_IF_ERROR(SettleNoise(*std::move(noise)));
  return options_.judge ? options_.judge(Counts()) : absl::OkStatus();
}

// Takes it over, and uses all that was held back.
absl::Status MapBuilding::SettleNoise(MeshNoise noise) {
  noise_ = std::move(noise);
  awaits_noise_ = false;
  evaluations_ += noise_.evaluations;
  noise_floor_.resize(plan_.metrics.size());
  for (std::size_t m = 0; m < noise_.metrics.size(); ++m) {
    if (noise_.metrics[m]) noise_floor_[m] = *noise_.metrics[m];
  }
  for (const auto& structure : structures_) {
    MORTISE_RETURN_IF_ERROR(structure->SetNoiseFloor(noise_floor_));
  }
  if (shapes_) shapes_->SetNoise(noise_);
  const auto held_back = std::exchange(held_back_, {});
  for (const auto& [asked, answer] : held_back) MORTISE_RETURN_IF_ERROR(Use(asked, answer));
  return absl::OkStatus();
}

// After a failure: what other calls have found meanwhile need not be found again. The failure that
// is told is the first.
void MapBuilding::KeepWhatIsUnderWay() {
  has_failed_ = true;
  if (shapes_) shapes_->Stop();
  while (!IsIdle()) {
    if (const std::optional<Event> event = mailbox_.Take(kCancelPoll)) (*event)().IgnoreError();
  }
  if (shapes_) shapes_->Keep().IgnoreError();
}

// 0 where nothing is measured yet.
double MapBuilding::LargestOf(const maps::MapSamplingProgress& progress) const {
  return std::max(progress.outside_error, maps::RelativeError(progress.errors.largest, noise_floor_,
                                                              progress.errors.range));
}

absl::StatusOr<std::optional<ShapedStructure>> MapBuilding::ShapesOf(std::size_t structure) const {
  MORTISE_RETURN_IF_ERROR(structures_[structure]->Content().status());
  if (!shapes_) return std::nullopt;
  MORTISE_ASSIGN_OR_RETURN(ShapedStructure result, shapes_->Result(structure));
  return std::optional<ShapedStructure>(std::move(result));
}

StopReason MapBuilding::ReasonOf(std::size_t structure) const {
  if (!structures_[structure]->Done()) return stopped_by_;
  const double error = LargestOf(structures_[structure]->Progress());
  return error <= options_.sampling.tolerance ? StopReason::kConverged : StopReason::kBudget;
}

BuildProgress MapBuilding::Counts() const {
  BuildProgress progress;
  progress.evaluations = evaluations_;
  progress.failures = failures_.failures();
  for (const evaluation::FailureCount& failure : progress.failures) {
    progress.failed += failure.count;
  }
  if (shapes_) {
    progress.meshes = shapes_->mesh_count();
    progress.shapes = shapes_->work().mapped();
    progress.to_map = shapes_->work().to_map();
    progress.unmapped = shapes_->work().failed();
    progress.unmapped_failures = shapes_->work().failures();
  }
  return progress;
}

BuildProgress MapBuilding::progress() const {
  BuildProgress progress = Counts();
  for (const auto& structure : structures_) {
    const maps::MapSamplingProgress now = structure->Progress();
    progress.elements += now.elements;
    progress.is_measured = progress.is_measured || now.errors.probes > 0;
    progress.error = std::max(progress.error, LargestOf(now));
  }
  return progress;
}

}  // namespace mortise::interpolator
