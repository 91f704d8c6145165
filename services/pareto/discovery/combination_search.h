// Searches within one combination of discrete values: it tries designs, and then makes one
// discovery after the other, each beginning with all that is known.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "services/pareto/archive/evaluation.h"
#include "services/pareto/discovery/discovery.h"
#include "services/pareto/models/combinations.h"
#include "services/pareto/models/surrogate_quality.h"
#include "services/pareto/sources/patch_sampling.h"

namespace mortise::pareto {

class CombinationSearch {
 public:
  struct Design {
    Eigen::VectorXd x;         // D
    std::int64_t number = -1;  // of a discovery's proposal; -1: a design to try
  };

  // `space` has the discrete parameters fixed. `options` are those of each discovery but for the
  // budget and the seed, which begins a sequence of seeds, and have no initial designs. They have
  // been checked.
  CombinationSearch(const DesignSpace& space, Eigen::Index metric_count,
                    const Discovery::Options& options);

  // Puts designs into the queue of what is tried before anything else.
  void Try(const std::vector<Eigen::VectorXd>& designs);

  // Returns a design to try that is given at once.
  Design TryNow(const Eigen::VectorXd& x);

  // Plans what comes after the designs to try: a discovery of so many evaluations, 1 at least.
  void Plan(std::int64_t evaluations) { planned_ = evaluations; }

  // Returns the next design; nullopt while results are needed first, and when there is nothing to
  // do.
  std::optional<Design> Ask();
  // Returns the next design of those to try only.
  std::optional<Design> AskQueued();

  // Takes what became of a design, in the order in which designs were given.
  void Tell(std::int64_t number, Evaluation evaluation);

  // Whether all that was planned has been done.
  bool IsIdle() const { return queue_.empty() && planned_ == 0 && discovery_ == nullptr; }
  // Whether a discovery found nothing more to do before its budget was spent.
  bool exhausted() const { return exhausted_; }
  std::int64_t last_plan() const { return last_plan_; }  // evaluations; 0 before the first

  // Returns the pieces of all discoveries, in unit coordinates of the parameters that vary.
  std::vector<AffinePiece> Pieces() const;
  std::int64_t Optimizations() const;
  std::int64_t Expansions() const;
  SurrogateTally Surrogates() const;

 private:
  void Begin();

  DesignSpace space_;
  Eigen::Index metric_count_;
  Discovery::Options options_;
  std::deque<Eigen::VectorXd> queue_;
  std::int64_t planned_ = 0;
  std::int64_t last_plan_ = 0;
  int tried_under_way_ = 0;
  bool exhausted_ = false;
  std::unique_ptr<Discovery> discovery_;
  std::vector<Evaluation> known_;
  // The sums over earlier discoveries.
  std::vector<AffinePiece> pieces_;
  std::int64_t optimizations_ = 0;
  std::int64_t expansions_ = 0;
  SurrogateTally surrogates_;
};

}  // namespace mortise::pareto
