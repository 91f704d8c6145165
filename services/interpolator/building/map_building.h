// Samples a map: which designs to ask next, several calls at once, what became of them.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/mailbox.h"
#include "common/base/thread_pool.h"
#include "common/evaluation/failures/failure_tally.h"
#include "common/maps/map_sampling.h"
#include "services/interpolator/building/design_answer.h"
#include "services/interpolator/building/known_shapes.h"
#include "services/interpolator/building/map_plan.h"
#include "services/interpolator/building/mesh_noise.h"
#include "services/interpolator/building/shape_building.h"
#include "services/interpolator/building/shape_options.h"
#include "services/interpolator/building/shaped_structure.h"

namespace mortise::interpolator {

// A design that a map asks for: the `number`-th of a structure.
struct DesignKey {
  int structure = 0;
  std::int64_t number = 0;

  auto operator<=>(const DesignKey&) const = default;
};

using KnownAnswers = std::map<DesignKey, DesignAnswer>;

enum class StopReason { kConverged, kBudget, kTime, kCancelled };

// "CONVERGED", "BUDGET", "TIME", "CANCELLED".
const char* StopReasonName(StopReason reason);

// How far a map is.
struct BuildProgress {
  std::int64_t evaluations = 0;
  std::int64_t failed = 0;                         // of those
  std::vector<evaluation::FailureCount> failures;  // why; the designs as points (P)
  std::int64_t elements = 0;
  double error = 0;          // the largest over the range of its metric, of all structures
  bool is_measured = false;  // whether that is known of any: new elements have no probes yet
  // Of maps with shapes:
  int meshes = 0;             // canonical ones
  std::int64_t shapes = 0;    // designs brought into them, each into one mesh
  std::int64_t to_map = 0;    // designs that are still to be, as far as is known
  std::int64_t unmapped = 0;  // that could not be, likewise, or that no mesh could be made of
  std::vector<evaluation::FailureCount> unmapped_failures;  // why; without the designs
};

struct BuildOptions {
  maps::MapSamplingOptions sampling;  // of each structure; the plan has the budget of all
  int batch_size = 1;                 // designs in one call of the evaluator, at most
  int lanes = 1;  // calls under way at once. Neither changes the map, only the time it takes.
  // Evaluates designs (D values each) in their order: called by several threads at once. A failure
  // means that the evaluator itself is out of reach.
  std::function<absl::StatusOr<std::vector<DesignAnswer>>(const std::vector<Eigen::VectorXd>&)>
      evaluate;
  std::function<void()> interrupt;  // asks calls of `evaluate` to return soon
  std::function<bool()> cancelled;  // asked ten times a second; true: stop with what there is
  // Likewise; it counts once there is a map of each structure.
  std::function<bool()> is_out_of_time;
  // Called with the answers of each batch before anything else happens with them. A failure stops
  // the build as if the evaluator were lost.
  std::function<absl::Status(const KnownAnswers&)> keep;
  // After batches, as often as that takes no more than a tenth of the time.
  std::function<void(const BuildProgress&)> progress;
  // After each batch, with how many designs were evaluated and failed, and why: why the whole
  // subject is at fault, which ends the build; OK to go on.
  std::function<absl::Status(const BuildProgress&)> judge;
  // Called each time that no answer has come for `quiet`, with how long there has been none.
  std::function<void(std::chrono::seconds)> waiting;
  std::chrono::milliseconds quiet{10'000};
  // Shapes and fields beside the metrics; none if absent. There may be no metrics then.
  std::optional<ShapeOptions> shapes;
  // Noise floors that nobody has given, in the place of those of `sampling` and `shapes`: the
  // design in the middle of the first structure's box is evaluated once more, which counts in the
  // plan's evaluations. None are estimated if absent.
  std::optional<MeshNoiseOptions> noise;
};

// One build. Its callbacks are called on the thread that runs it.
class MapBuilding {
 public:
  // `plan` and `options` outlive it. Fails as MapSampling::Create.
  static absl::StatusOr<std::unique_ptr<MapBuilding>> Create(const MapPlan& plan,
                                                             const BuildOptions& options);

  // Samples until every structure has what it needs, or is stopped. Answers that are already known,
  // from a build that was interrupted, are taken from `known`, also if it is stopped at once: the
  // map is the same. So is what is known of shapes, which need not be mapped again. Returns why the
  // evaluator was lost, if it was, or what `judge` said, or why shapes could not be put or read;
  // DATA_LOSS if `known` is of another map. An answer that is known and lacks the file that a map
  // with shapes needs is asked for again.
  absl::Status Run(const KnownAnswers& known, KnownShapes known_shapes = {});

  const std::vector<std::unique_ptr<maps::MapSampling>>& structures() const { return structures_; }
  // Why a structure is not sampled any more.
  StopReason ReasonOf(std::size_t structure) const;
  BuildProgress progress() const;
  // What was estimated of noise; nothing before it was, and where nothing was to be.
  const MeshNoise& noise() const { return noise_; }
  // The shapes of a structure, for its Content(): of the last complete round. Nothing of a build
  // without shapes. FAILED_PRECONDITION as Content().
  absl::StatusOr<std::optional<ShapedStructure>> ShapesOf(std::size_t structure) const;

 private:
  struct Asked {
    DesignKey key;
    Eigen::VectorXd design;  // D
  };
  using Batch = std::vector<std::pair<Asked, DesignAnswer>>;

  // Something that is to happen on the thread that runs the build.
  using Event = std::function<absl::Status()>;

  MapBuilding(const MapPlan& plan, const BuildOptions& options) : plan_(plan), options_(options) {}

  bool StopWhenAsked();
  bool HasMap() const;
  absl::Status Replay(const KnownAnswers& known);
  absl::Status FillLanes(const KnownAnswers& known, ThreadPool& lanes);
  absl::StatusOr<std::vector<Asked>> NextBatch(const KnownAnswers& known);
  const DesignAnswer* FindAnswer(const KnownAnswers& known, const DesignKey& key) const;
  absl::StatusOr<Batch> Evaluate(const std::vector<Asked>& asked) const;
  absl::StatusOr<DesignAnswer> Checked(DesignAnswer answer) const;
  absl::Status Receive(absl::StatusOr<Batch> batch);
  absl::Status Happen(const Event& first);
  bool IsIdle() const { return under_way_ == 0 && (shapes_ == nullptr || shapes_->IsIdle()); }
  absl::Status Tell(const Asked& asked, const DesignAnswer& answer);
  absl::Status Use(const Asked& asked, const DesignAnswer& answer);
  absl::Status HoldBack(const Asked& asked, const DesignAnswer& answer);
  void AskForNoise(ThreadPool& lanes);
  absl::Status ReceiveNoise(absl::StatusOr<MeshNoise> noise);
  absl::Status SettleNoise(MeshNoise noise);
  absl::StatusOr<MeshNoise> EstimateNoise(const DesignAnswer& one) const;
  void TellProgress();
  double LargestOf(const maps::MapSamplingProgress& progress) const;
  BuildProgress Counts() const;  // without errors and elements
  void KeepWhatIsUnderWay();
  absl::Status RunToItsEnd(const KnownAnswers& known, ThreadPool& lanes);

  const MapPlan& plan_;
  const BuildOptions& options_;
  std::vector<std::unique_ptr<maps::MapSampling>> structures_;
  evaluation::FailureTally failures_;
  std::int64_t evaluations_ = 0;
  std::size_t next_ = 0;  // structure to ask
  int under_way_ = 0;     // calls
  std::chrono::steady_clock::time_point next_progress_{};
  std::deque<std::vector<Asked>>
      waiting_;  // what was asked while answers were told that were known
  bool is_stopped_ = false;
  StopReason stopped_by_ = StopReason::kCancelled;
  bool has_failed_ = false;  // then answers are kept and no more
  Mailbox<Event> mailbox_;
  std::unique_ptr<ShapeBuilding> shapes_;  // null without shapes
  std::vector<double> noise_floor_;        // of metrics
  MeshNoise noise_;
  bool awaits_noise_ = false;  // then answers are held back
  std::vector<std::pair<Asked, DesignAnswer>> held_back_;
  std::optional<DesignAnswer> middle_;  // of the design that noise is estimated by
  bool has_asked_for_noise_ = false;
};

}  // namespace mortise::interpolator
