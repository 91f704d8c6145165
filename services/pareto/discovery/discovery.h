// Discovers the Pareto front (§7.5, Algorithm 2), as ask and tell.
//
// A seeded loop of local optimisations (local_optimization.h) and first-order expansions
// (patch_sampling.h) fills the performance buffer (performance_buffer.h) until the budget is spent
// or nothing improves any more. See track_scheduler.h for what is optimised next.
//
// Its parts: what it may spend (discovery_options.h), how that is divided (search_policy.h), what
// is under way (proposal_window.h, track_pool.h), and how it gets on (hypervolume_progress.h).
//
// **Asynchronous and yet deterministic.** Proposals and results are numbered, and a proposal
// depends on nothing but the seed and the answers before it (proposal_window.h): one slow
// evaluation stalls nothing until the window is full. (After the space-filling samples at the start
// everything is committed once.) Equal answers therefore give the same front bit for bit on any
// number of workers, and a run is resumed by telling the answers of the first part again: they are
// the whole of its state.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/random.h"
#include "common/evaluation/failures/failure_tally.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/discovery/ask_tell.h"
#include "services/pareto/discovery/discovery_options.h"
#include "services/pareto/discovery/evaluated_designs.h"
#include "services/pareto/discovery/hypervolume_progress.h"
#include "services/pareto/discovery/proposal_window.h"
#include "services/pareto/discovery/search_box.h"
#include "services/pareto/discovery/search_policy.h"
#include "services/pareto/discovery/surrogate_turns.h"
#include "services/pareto/discovery/track_pool.h"
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
  using Options = DiscoveryOptions;
  using Surrogate = DiscoveryOptions::Surrogate;

  // `metric_count` d of 1 to 6, all minimised. INVALID_ARGUMENT naming the field at fault
  // ("parameters[i].upper", "evaluations", "window", ...).
  static absl::StatusOr<std::unique_ptr<Discovery>> Create(const DesignSpace& space,
                                                           Eigen::Index metric_count,
                                                           const Options& options);

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

  const DesignSpace& space() const { return box_.space(); }
  const Archive& archive() const override { return archive_; }
  std::int64_t proposed() const { return window_.proposed(); }
  // Returns how many designs are evaluated before the search begins: those given and those that
  // fill the space.
  std::int64_t initial_samples() const override { return initial_samples_; }
  // Returns the affine pieces followed so far, in unit coordinates of the parameters that can vary.
  const std::vector<AffinePiece>& pieces() const { return pieces_; }
  const SurrogateTally& surrogate_tally() const { return surrogate_.tally(); }

 private:
  // What is kept of a proposal: its unit coordinates, and the track that asked for it.
  struct Origin {
    Eigen::VectorXd u;
    std::int64_t track = 0;
    bool is_surrogates = false;
  };
  using Window = ProposalWindow<Origin>;

  // An evaluation in the archive, and the hypervolume that it gained.
  struct Admitted {
    std::size_t entry = 0;
    double gain = 0;
  };

  Discovery(const DesignSpace& space, Eigen::Index metric_count, const Options& options);

  // Results, in discovery.cpp.
  bool CommitUpTo(std::int64_t count);
  void Commit(std::int64_t number, const Window::Proposed& proposed);
  ArchiveEntry EntryOf(const Eigen::VectorXd& u, const Evaluation& result) const;
  Admitted Admit(const Eigen::VectorXd& u, const Eigen::VectorXd& x, const Evaluation& result);
  double Absorb(std::size_t entry);

  // Proposals, in discovery.cpp.
  std::int64_t given() const { return options_.initial_designs.cols(); }
  std::optional<TrackPool::Request> Step();
  TrackPool::Request InitialDesign();
  std::optional<TrackPool::Request> RestoreConstraints();
  std::optional<TrackPool::Request> AskTracks(bool only_polishes);
  TrackPool::KnownDesign Find(const Eigen::VectorXd& u) const;
  bool PolishesOnly() const { return finishing_.PolishesOnly(window_.left()); }

  // The life of tracks, in discovery_tracks.cpp.
  void StartTrack(bool force_sample, bool polishes);
  void StartOptimization(bool force_sample, bool polishes);
  void StartFinishing();
  bool StartRestoration();
  void StartExpansion(const Track& of, std::size_t entry);
  void RetireFinished();
  void Retire(const Track& track);
  void RetireOpening(const Track& track);
  void RetireOptimization(const Track& track);
  bool MakesProgress(const Track& track);
  bool MayMeasure() const;
  bool OffersGradients() const;
  bool UsesSurrogate() const;
  bool SurrogateIsDue() const;
  std::optional<TrackPool::Request> AskSurrogate();

  // These are the opening, in discovery_opening.cpp.
  bool AwaitsOpening() const;
  void LearnFromLines();
  void TryLeastAlongLines();
  void TraverseFromMiddle();
  void StartTraverses(std::size_t entry);
  std::unique_ptr<PointSource> MakeDescent();

  SearchBox box_;
  Eigen::Index metric_count_;
  Options options_;
  SearchPolicy policy_;
  Window window_;
  Archive archive_;
  PerformanceBuffer buffer_;
  EvaluatedDesigns evaluated_;
  // The designs of entries whose design is, to the last bit, another one than that of their unit
  // coordinates.
  std::unordered_map<std::size_t, Eigen::VectorXd> designs_;
  std::vector<Eigen::VectorXd> deviations_;  // of each entry

  TrackPool tracks_;
  TrackScheduler scheduler_;
  Population population_;
  SurrogateSearch surrogate_;
  SurrogateTurns turns_;
  EvolutionSearch evolution_;
  FrontFinishing finishing_;
  Random random_;
  std::int64_t initial_samples_;
  std::vector<Eigen::VectorXd> space_filling_;  // unit coordinates
  std::vector<AffinePiece> pieces_;
  int probed_patches_ = 0;
  std::int64_t measured_ = 0;  // evaluations for slopes of pieces by differences
  std::int64_t idle_ = 0;      // evaluations there was room for while results were awaited
  bool opened_ = false;        // whether a track for the front has begun
  bool descending_ = false;    // along one parameter after the other, before anything else
  std::set<std::size_t> restored_from_;  // entries
  std::vector<Eigen::Index> trading_;    // parameters, see LearnFromLines
  std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> traverses_;  // parameters and starts
  std::map<Eigen::Index, int> traversed_;                            // how often, by parameter

  double hypervolume_ = 0;    // in the scaling of the buffer, up to kRunningReference
  double progress_mark_ = 0;  // hypervolume when progress was last made
  int tracks_since_progress_ = 0;
  std::int64_t failed_ = 0;
  std::int64_t learnt_violating_ = 0;  // evaluations made elsewhere, beyond constraints
  evaluation::FailureTally failures_;
  std::int64_t optimizations_ = 0;
  std::int64_t expansions_ = 0;
  std::int64_t surrogate_track_ = -3;  // of its last proposal
  mutable ShownHypervolume shown_;     // by summary()
  StopReason stop_ = StopReason::kRunning;
  std::string message_;
};

}  // namespace mortise::pareto
