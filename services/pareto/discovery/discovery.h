// Discovers the Pareto front (§7.5, Algorithm 2), as ask and tell.
//
// A seeded loop of local optimisations (local_optimization.h) and first-order expansions
// (patch_sampling.h) fills the performance buffer (performance_buffer.h) until the budget is spent
// or nothing improves any more. See track_scheduler.h for what is optimised next.
//
// **Asynchronous and yet deterministic.** Proposals and results are numbered. Results are committed
// in the order of their numbers, whenever they arrive, and proposal k is made when exactly the
// results 0 ... k - window have been committed: up to `window` evaluations are under way at once,
// one slow evaluation stalls nothing until the window is full, and the proposals depend on nothing
// but the seed and the answers. (After the space-filling samples at the start everything is
// committed once.) Equal answers therefore give the same front bit for bit on any number of
// workers, and a run is resumed by telling the answers of the first part again: they are the whole
// of its state.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/archive/failure_tally.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/discovery/ask_tell.h"
#include "services/pareto/discovery/track_scheduler.h"
#include "services/pareto/front/front.h"
#include "services/pareto/models/surrogate_quality.h"
#include "services/pareto/sources/evolution_search.h"
#include "services/pareto/sources/front_finishing.h"
#include "services/pareto/sources/patch_sampling.h"
#include "services/pareto/sources/population.h"
#include "services/pareto/sources/surrogate_search.h"

namespace mortise::pareto {

class Discovery : public AskTell {
 public:
  // Whether a surrogate proposes designs (surrogate_search.h), four of five after the space-filling
  // ones, at some 20 ms to a second each. Automatically it does with budgets of up to 30
  // evaluations a parameter (or 300 in all), less than 1,000, for up to 40 parameters, unless all
  // gradients are offered.
  enum class Surrogate { kAutomatic, kAlways, kNever };

  struct Options {
    std::int64_t evaluations = 1000;  // budget, 1 to 10,000,000
    std::uint64_t seed = 1;
    int window = 8;  // evaluations under way at once, 1 to 4096; part of what is computed
    // The cells per angle of the buffer, up to 10,000; 0 stands for 1000 for d = 2, and 100 for 3.
    // For d > 3 it is the finest (0 stands for 64), and the buffer adapts so that one cell for four
    // evaluations is occupied, 50 to 4,000.
    int cells_per_angle = 0;
    int constraints = 0;      // m, told with each evaluation, 0 to 64
    int initial_samples = 0;  // space-filling designs at the start; 0: D + 3, with constraints D +
                              // 23, at most a quarter of the budget
    Surrogate surrogate = Surrogate::kAutomatic;
    // The designs of the space to evaluate before any other, D x n, fewer than `evaluations`; see
    // warm_start.h.
    Eigen::MatrixXd initial_designs = {};
    double delta_b = 1e-2;   // tolerance of the buffer, scaled performance
    double delta_i = 1e-4;   // improvement of hypervolume (relative) that counts as progress
    int stall_tracks = 300;  // optimisations in a row without progress that end it; 0: never
    // True if proposals go by every result told so far rather than by those that the window makes
    // sure of. This is for a caller that tells at times which depend on nothing but seed and
    // answers.
    bool uses_all_told = false;
    TrackScheduler::Options scheduling;
  };

  // `metric_count` d of 1 to 6, all minimised. INVALID_ARGUMENT naming the field at fault
  // ("parameters[i].upper", "evaluations", "window", ...).
  static absl::StatusOr<std::unique_ptr<Discovery>> Create(const DesignSpace& space,
                                                           Eigen::Index metric_count,
                                                           const Options& options);

  // Returns the options of the buffer of a discovery of d metrics.
  static PerformanceBuffer::Options BufferOptions(const Options& options, Eigen::Index d);

  std::optional<Proposal> Ask() override;
  absl::Status Tell(std::int64_t number, Evaluation evaluation) override;
  void Stop(StopReason reason, std::string message) override;
  bool Finished() const override { return stop_ != StopReason::kRunning; }
  Summary summary() const override;
  Front front() const override;

  // Takes an evaluation that was made elsewhere, of a design within the bounds. From now on it is
  // known, as if it had been proposed. It takes no number and nothing of the budget, and the
  // summary does not count it; before the first proposal it takes the place of one of the
  // space-filling designs. Fails as Tell does. (Entries of the archive then have other numbers than
  // proposals.)
  absl::Status Learn(const Evaluation& evaluation);

  const DesignSpace& space() const { return space_; }
  const Archive& archive() const override { return archive_; }
  std::int64_t proposed() const { return proposed_; }
  // Returns how many designs are evaluated before the search begins: those given and those that
  // fill the space.
  std::int64_t initial_samples() const override { return initial_samples_; }
  // Returns the affine pieces followed so far, in unit coordinates of the parameters that can vary.
  const std::vector<AffinePiece>& pieces() const { return pieces_; }
  const SurrogateTally& surrogate_tally() const { return surrogate_.tally(); }

 private:
  // A point of a track.
  struct Asked {
    std::int64_t number = -1;  // of the proposal that answers it, while that is under way
    std::optional<std::size_t> entry = {};
  };

  struct Track {
    std::unique_ptr<PointSource> source;
    LocalOptimization* optimization = nullptr;  // the source, if it is one
    PatchSampling* patch = nullptr;             // the source, if it is one
    TrackKind kind = TrackKind::kOpening;
    double gain = 0;
    int evaluations = 0;
    std::deque<Asked> asked = {};
  };

  struct Pending {
    Eigen::VectorXd u;
    Eigen::VectorXd x;
    std::int64_t track = -1;  // -1: an initial sample
    std::optional<Evaluation> result;
  };

  Discovery(const DesignSpace& space, Eigen::Index metric_count, const Options& options);

  bool CommitUpTo(std::int64_t count);
  void CommitNext();
  ArchiveEntry EntryOf(const Pending& pending) const;
  std::optional<std::size_t> EvaluatedAt(const Eigen::VectorXd& u) const;
  double Admit(const Pending& pending, std::size_t& entry);
  double Absorb(std::size_t entry);
  double GainOf(std::size_t entry) const;
  Eigen::VectorXd InitialDesign();
  std::int64_t Left() const { return options_.evaluations - proposed_; }
  std::int64_t given() const { return options_.initial_designs.cols(); }
  Eigen::VectorXd DesignAt(const Eigen::VectorXd& u) const;
  Eigen::VectorXd UnitOf(const Eigen::VectorXd& x) const;
  std::optional<Eigen::VectorXd> NextPoint(std::int64_t& track);
  bool AwaitsOpening() const;
  std::optional<Eigen::VectorXd> AskTracks(std::int64_t& track, bool polishes);
  std::optional<Eigen::VectorXd> AskTrack(Track& track);
  void Answer(std::int64_t number, std::size_t entry);
  std::optional<std::int64_t> UnderWayAt(const Eigen::VectorXd& u) const;
  void TellInOrder(Track& track);
  void RetireFinished();
  void Retire(const Track& track);
  void LearnFromLines();
  void TryLeastAlongLines();
  void TraverseFromMiddle();
  void StartTraverses(std::size_t entry);
  bool MayMeasure() const;
  bool Explores() const;
  std::unique_ptr<PointSource> MakeDescent();
  void StartTrack(bool force_sample, bool polishes);
  bool OffersGradients() const;
  bool UsesSurrogate() const;
  bool SurrogateIsDue() const;
  std::optional<Eigen::VectorXd> AskSurrogate(std::int64_t& track);
  bool StartRestoration();
  void StartFinishing();
  double DominatedVolume(const Scaling& scaling, double reference, int samples) const;

  DesignSpace space_;
  std::vector<Eigen::Index> free_;  // the parameters that can vary, which is all the search sees
  DesignSpace box_;                 // of those
  Eigen::Index metric_count_;
  Options options_;
  Archive archive_;
  PerformanceBuffer buffer_;
  TrackScheduler scheduler_;
  Population population_;
  SurrogateSearch surrogate_;
  EvolutionSearch evolution_;
  FrontFinishing finishing_;
  Random random_;
  std::int64_t initial_samples_;
  std::vector<Eigen::VectorXd> space_filling_;  // unit coordinates
  double spacing_;  // wanted distance of trade-offs along patches, for the budget
  std::map<std::int64_t, Track> tracks_;  // by age
  std::int64_t next_track_ = 0;
  std::map<std::int64_t, Pending> pending_;                      // proposed, not committed
  std::unordered_multimap<std::size_t, std::size_t> evaluated_;  // hash of u to entry: never twice
  // The designs of entries whose design is, to the last bit, another one than that of their unit
  // coordinates.
  std::unordered_map<std::size_t, Eigen::VectorXd> designs_;
  std::vector<Eigen::VectorXd> deviations_;  // of each entry
  std::vector<AffinePiece> pieces_;
  std::int64_t proposed_ = 0;
  std::int64_t committed_ = 0;
  std::int64_t idle_ = 0;     // evaluations that there was room for while results were waited for
  std::int64_t barrier_ = 0;  // results that must be committed before the next proposal
  std::int64_t failed_ = 0;
  std::int64_t learnt_violating_ = 0;    // evaluations made elsewhere, beyond constraints
  bool opened_ = false;                  // a track for the front has begun
  std::set<std::size_t> restored_from_;  // entries
  FailureTally failures_;
  std::int64_t optimizations_ = 0;
  std::int64_t expansions_ = 0;
  std::int64_t surrogate_proposals_ = 0;
  int probed_patches_ = 0;
  std::int64_t measured_ = 0;          // evaluations for slopes of pieces by differences
  std::vector<Eigen::Index> trading_;  // parameters, see LearnFromLines
  std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> traverses_;  // parameters and starts
  std::map<Eigen::Index, int> traversed_;                            // how often, by parameter
  bool descending_ = false;  // along one parameter after the other, before anything else
  double hypervolume_ = 0;   // in the scaling of the buffer, reference 1.1
  struct Shown {
    std::int64_t committed = 0;
    double hypervolume = 0;
  };
  mutable Shown shown_;       // by summary()
  double progress_mark_ = 0;  // hypervolume when progress was last made
  int tracks_since_progress_ = 0;
  StopReason stop_ = StopReason::kRunning;
  std::string message_;
};

}  // namespace mortise::pareto
