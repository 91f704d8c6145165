// Discovers a front where some parameters are discrete: one for each combination of their values,
// merged as it goes, so that evaluations go to the combinations that the merged front consists of.
// The algorithm is our own.
//
// **Opening.** Each combination gets some space-filling designs and, from the first trade-offs of
// the others, transplants: designs of the merged front with this combination's values in the place
// of theirs. Where there are more combinations than a third of the budget can open, those that are
// opened fill the space of combinations.
//
// **Shares.** After that, combinations share the evaluations by how much hypervolume of the merged
// front each has lately brought for an evaluation, counting only what is still on that front; a
// part is shared by how near the front they are. Each goes on with discoveries that begin with all
// that is known, among it new transplants. Another part goes to single transplants, from what is on
// the front to its neighbours, those that differ in one value, at the designs where a model of what
// values add (combination_model.h) expects most. So combinations come in that were not opened, too.
//
// **Pruning.** A combination is given up when it has had its opening and one of these holds:
// - All of its designs are dominated by so much that as much as it has lately come nearer to the
//   front, which moves, would not take it there: by 0.3 of the front's range in every metric after
//   the opening, half of that after twice as many evaluations, and so on down to 2 delta_B.
// - None of its designs can be evaluated.
// - None of its opening and of twenty more is within the constraints, while others are.
//
// When three fifths and nine tenths of the budget are spent, the combinations that were given up
// have another look: transplants of what is the front by then. Those that come near enough go on;
// all go on where nothing else is left to do.
//
// Designs to begin with come before all that, each for the combination that it is of.
//
// The window, numbers and determinism are those of proposal_window.h. A surrogate takes part only
// where the options say that it always does: each combination is told of too little for long.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/random.h"
#include "common/evaluation/failures/failure_tally.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/discovery/ask_tell.h"
#include "services/pareto/discovery/combination_search.h"
#include "services/pareto/discovery/discovery.h"
#include "services/pareto/discovery/hypervolume_progress.h"
#include "services/pareto/discovery/proposal_window.h"
#include "services/pareto/models/combination_model.h"
#include "services/pareto/models/combinations.h"

namespace mortise::pareto {

class CombinedDiscovery : public AskTell {
 public:
  // `discrete` are parameters of `space` that take each of their values by itself, of which there
  // are two combinations or more. INVALID_ARGUMENT as Discovery::Create and Validate of `discrete`,
  // and "initial_designs[i]" for one of no combination.
  static absl::StatusOr<std::unique_ptr<CombinedDiscovery>> Create(
      const DesignSpace& space, const std::vector<DiscreteParameter>& discrete,
      Eigen::Index metric_count, const Discovery::Options& options);

  std::optional<Proposal> Ask() override;
  absl::Status Tell(std::int64_t number, Evaluation evaluation) override;
  void Stop(StopReason reason, std::string message) override;
  bool Finished() const override { return stop_ != StopReason::kRunning; }
  Summary summary() const override;
  // Each piece is of one combination.
  Front front() const override;
  // Unit coordinates are of the whole space; no Jacobians.
  const Archive& archive() const override { return archive_; }
  std::int64_t initial_samples() const override;

 private:
  enum class Stage { kOpening, kSearching, kPruned };

  // A combination, and what is known of it.
  struct Member {
    Combination combination;
    DesignSpace space;  // its discrete parameters fixed
    std::unique_ptr<CombinationSearch> search;
    Stage stage = Stage::kOpening;
    std::vector<std::size_t> entries = {};  // of the archive
    std::int64_t proposed = 0;
    int transplants = 0;  // of other combinations' designs, one by one
    double gap = 0;       // to the merged front when that was last looked at
    std::vector<std::pair<std::size_t, double>> gaps = {};  // entries, and the gap found then
    double spent = 0;                                       // evaluations, lately
    double owed = 0;                                        // evaluations
  };

  // What asked for a proposal: a member, and the number that its search gave it.
  struct Origin {
    std::size_t member = 0;
    std::int64_t number = -1;
  };
  using Window = ProposalWindow<Origin>;

  struct Next {
    std::size_t member = 0;
    CombinationSearch::Design design;
  };

  CombinedDiscovery(const DesignSpace& space, const std::vector<DiscreteParameter>& discrete,
                    Eigen::Index metric_count, const Discovery::Options& options);

  void OpenGiven();
  void MakeOpening();
  std::size_t AddMember(const Combination& combination);
  bool CommitUpTo(std::int64_t count);
  void Commit(Window::Proposed proposed);
  double Absorb(std::size_t entry);

  std::optional<Next> NextDesign();
  std::optional<Next> AskShared();
  std::optional<CombinationSearch::Design> AskOpening(std::size_t& member);
  std::optional<CombinationSearch::Design> AskOf(Member& member);
  bool PlanFor(Member& member);
  std::vector<std::size_t> Searching() const;
  std::vector<double> Shares(const std::vector<std::size_t>& members) const;
  std::optional<Next> AskTransplant();
  void ChooseTransplants();

  void Prune();
  void LookAgain();
  double GapOf(const Member& member, std::size_t count) const;
  double EarlierGap(const Member& member, std::size_t count) const;
  bool IsHopeless(const Member& member) const;

  std::vector<std::size_t> Sources(const Member* without, std::size_t most) const;
  std::vector<Eigen::VectorXd> Transplants(const Member& member, std::size_t most);
  Eigen::VectorXd Transplanted(std::size_t source, const Member& member) const;
  CombinationModel LearntModel() const;
  Eigen::VectorXd OthersOf(std::size_t entry) const;

  DesignSpace space_;
  CombinationSpace combinations_;
  std::vector<Eigen::Index> others_;  // parameters that vary and are not discrete
  Eigen::Index metric_count_;
  Discovery::Options options_;
  Random random_;
  Window window_;
  Archive archive_;
  std::vector<std::size_t> member_of_;       // of each entry
  std::vector<Eigen::VectorXd> evaluated_;   // of each entry, bit for bit as evaluated
  std::vector<Eigen::VectorXd> deviations_;  // of each entry
  std::vector<double> gains_;                // hypervolume that each entry brought when it came
  PerformanceBuffer buffer_;
  std::vector<Member> members_;
  std::map<Combination, std::size_t> index_;
  std::vector<Next> opening_;             // the designs given and the space-filling ones
  std::deque<std::size_t> to_open_;       // members, in order
  std::deque<std::size_t> looks_;         // members that have another look
  std::size_t transplants_ = 0;           // of an opening
  std::int64_t opening_evaluations_ = 0;  // of a combination
  double memory_ = 1;                     // of gains, with each evaluation
  std::int64_t next_check_ = 0;
  std::deque<std::pair<Combination, Eigen::VectorXd>> transplanted_;  // to be tried
  double transplant_owed_ = 0;
  bool opened_ = false;
  int looked_ = 0;
  std::set<std::vector<double>> designs_;  // proposed
  std::int64_t failed_ = 0;
  evaluation::FailureTally failures_;
  mutable ShownHypervolume shown_;  // by summary()
  StopReason stop_ = StopReason::kRunning;
  std::string message_;
};

// Returns a discovery of `space`, whose parameters `discrete` take each of their values by itself:
// a CombinedDiscovery, or where there is one combination only, the Discovery of that.
absl::StatusOr<std::unique_ptr<AskTell>> MakeDiscovery(
    const DesignSpace& space, const std::vector<DiscreteParameter>& discrete,
    Eigen::Index metric_count, const Discovery::Options& options);

}  // namespace mortise::pareto
