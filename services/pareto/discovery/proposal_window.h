// Numbers the proposals of a discovery, and commits their results in that order, whenever they
// arrive.
//
// Proposal k is made when exactly the results 0 ... k - width have been committed, so that up to
// `width` evaluations are under way at once and what is proposed depends on the answers alone, not
// on when they come. A barrier lets everything that is under way be committed once.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/archive/evaluation.h"

namespace mortise::pareto {

// Says how many numbers an answer has.
struct AnswerSizes {
  Eigen::Index parameters = 0;   // D
  Eigen::Index metrics = 0;      // d
  Eigen::Index constraints = 0;  // m
};

// `Origin` is what a discovery keeps of a proposal: what asked for it.
template <typename Origin>
class ProposalWindow {
 public:
  struct Proposed {
    Eigen::VectorXd x;
    Origin origin;
    std::optional<Evaluation> result = {};
  };

  // `budget` is how many proposals there may be, and `width` how many are under way at once.
  ProposalWindow(std::int64_t budget, int width, const AnswerSizes& sizes)
      : budget_(budget), width_(width), sizes_(sizes) {}

  std::int64_t proposed() const { return proposed_; }
  std::int64_t committed() const { return committed_; }
  // Returns how many more may be proposed.
  std::int64_t left() const { return budget_ - proposed_; }
  // Returns how many more have room beside those that are under way.
  std::int64_t room() const { return width_ - std::ssize(under_way_); }
  // Returns those that were proposed and are not committed, by number.
  const std::map<std::int64_t, Proposed>& under_way() const { return under_way_; }

  // Sets the barrier: before the next proposal all that have been made so far are committed.
  void AwaitAll() { barrier_ = proposed_; }

  // Returns how many results must be committed before the next proposal is made.
  std::int64_t needed() const {
    return std::max({std::int64_t{0}, proposed_ - width_ + 1, barrier_});
  }

  // Makes the next proposal; returns its number.
  std::int64_t Propose(Eigen::VectorXd x, Origin origin) {
    under_way_.emplace(proposed_, Proposed{std::move(x), std::move(origin)});
    return proposed_++;
  }

  // Takes a result. INVALID_ARGUMENT naming "number" where none is awaited, "x" for another design
  // than was proposed, else as CheckAnswer.
  absl::Status Tell(std::int64_t number, Evaluation evaluation) {
    const auto at = under_way_.find(number);
    if (at == under_way_.end() || at->second.result) {
      return InvalidField("number", absl::StrCat("no result is awaited for proposal ", number));
    }
    if (evaluation.x != at->second.x) {
      return InvalidField("x", absl::StrCat("not the design of proposal ", number));
    }
    MORTISE_RETURN_IF_ERROR(
        CheckAnswer(evaluation, sizes_.parameters, sizes_.metrics, sizes_.constraints));
    at->second.result = std::move(evaluation);
    return absl::OkStatus();
  }

  // Commits results in the order of their numbers until there are `count`, or `commit` returns
  // false: it is given each number with its proposal, which has a result. It may itself call this.
  // Returns false if a result is missing.
  bool CommitUpTo(std::int64_t count,
                  const std::function<bool(std::int64_t number, Proposed proposed)>& commit) {
    while (committed_ < count) {
      const auto first = under_way_.find(committed_);
      if (first == under_way_.end() || !first->second.result) return false;
      Proposed proposed = std::move(first->second);
      under_way_.erase(first);
      if (!commit(committed_++, std::move(proposed))) return true;
    }
    return true;
  }

 private:
  std::int64_t budget_;
  int width_;
  AnswerSizes sizes_;
  std::int64_t proposed_ = 0;
  std::int64_t committed_ = 0;
  std::int64_t barrier_ = 0;
  std::map<std::int64_t, Proposed> under_way_;
};

}  // namespace mortise::pareto
