// The window of proposals and results over all combinations, and what is kept of them.
#include "services/pareto/discovery/combined_discovery.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/archive/stochastic_sampling.h"
#include "services/pareto/discovery/search_policy.h"
#include "services/pareto/models/surrogate_quality.h"

namespace mortise::pareto {
namespace {

constexpr double kLately = 100;              // evaluations
constexpr double kOpeningShare = 0.35;       // of the budget
constexpr double kSpaceFillingShare = 0.15;  // the same for the space-filling designs
constexpr double kTransplantShare = 0.1;     // and for the first transplants
constexpr std::int64_t kMaxTransplants = 3;

std::vector<double> Key(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

}  // namespace

absl::StatusOr<std::unique_ptr<CombinedDiscovery>> CombinedDiscovery::Create(
    const DesignSpace& space, const std::vector<DiscreteParameter>& discrete,
    Eigen::Index metric_count, const Discovery::Options& options) {
  MORTISE_RETURN_IF_ERROR(pareto::Validate(space));
  MORTISE_RETURN_IF_ERROR(pareto::Validate(discrete, space));
  // What it says of the options holds for each combination.
  MORTISE_RETURN_IF_ERROR(Discovery::Create(space, metric_count, options).status());
  const CombinationSpace combinations(space, discrete);
  for (Eigen::Index i = 0; i < options.initial_designs.cols(); ++i) {
    if (!combinations.Of(options.initial_designs.col(i))) {
      return InvalidField(absl::StrCat("initial_designs[", i, "]"),
                          "has a discrete parameter at none of its values");
    }
  }
  return absl::WrapUnique(new CombinedDiscovery(space, discrete, metric_count, options));
}

CombinedDiscovery::CombinedDiscovery(const DesignSpace& space,
                                     const std::vector<DiscreteParameter>& discrete,
                                     Eigen::Index metric_count, const Discovery::Options& options)
    : space_(space),
      combinations_(space, discrete),
      others_(OtherParameters(space, discrete)),
      metric_count_(metric_count),
      options_(options),
      random_(options.seed ^ 0xc0b1ULL),
      window_(options.evaluations, options.window,
              {space.size(), metric_count, options.constraints}),
      buffer_(BufferOptions(options, metric_count), metric_count) {
  if (options_.surrogate == Discovery::Surrogate::kAutomatic) {
    options_.surrogate = Discovery::Surrogate::kNever;
  }
  MakeOpening();
  OpenGiven();
}

// Puts the designs that were given before the others. Where there is one design of each
// combination, it is opened with that alone.
void CombinedDiscovery::OpenGiven() {
  std::vector<Next> given;
  std::set<std::size_t> members;
  for (const auto& x : options_.initial_designs.colwise()) {
    const Combination combination = *combinations_.Of(x);
    const auto known = index_.find(combination);
    const std::size_t member = known == index_.end() ? AddMember(combination) : known->second;
    if (!members.insert(member).second && others_.empty()) continue;
    given.push_back({member, {x}});
  }
  for (Next& next : opening_) {
    if (!others_.empty() || !members.contains(next.member)) given.push_back(std::move(next));
  }
  opening_ = std::move(given);
}

// How many combinations are opened, with how many designs, and which.
void CombinedDiscovery::MakeOpening() {
  const auto size = static_cast<std::int64_t>(others_.size());
  const auto budget = static_cast<double>(options_.evaluations);
  const auto all = static_cast<double>(combinations_.count());
  std::int64_t samples = 1;
  if (size > 0) {
    samples = std::clamp<std::int64_t>(static_cast<std::int64_t>(kSpaceFillingShare * budget / all),
                                       1, (size + 4) / 2);
    transplants_ = static_cast<std::size_t>(std::clamp<std::int64_t>(
        static_cast<std::int64_t>(kTransplantShare * budget / all), 1, kMaxTransplants));
  }
  const std::int64_t least = samples + static_cast<std::int64_t>(transplants_);
  std::int64_t opened = static_cast<std::int64_t>(kOpeningShare * budget) / least;
  if (size == 0 && all <= budget) opened = combinations_.count();
  opened = std::clamp<std::int64_t>(opened, 1, combinations_.count());
  opening_evaluations_ = least;
  memory_ = 1 - 1 / std::max(kLately, 2.0 * static_cast<double>(opened));
  for (const Combination& combination : combinations_.SpaceFilling(opened, random_)) {
    AddMember(combination);
  }
  const std::vector<Eigen::VectorXd> designs = LatinHypercube(opened * samples, size, random_);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const std::size_t member = i % members_.size();
    const DesignSpace& fixed = members_[member].space;
    Eigen::VectorXd u = Eigen::VectorXd::Zero(fixed.size());
    u(others_) = designs[i];
    opening_.push_back({member, {fixed.FromUnit(u)}});
  }
}

std::size_t CombinedDiscovery::AddMember(const Combination& combination) {
  Discovery::Options options = options_;
  options.seed = Random(options_.seed + 0x9e37ULL * (members_.size() + 1)).Next();
  options.initial_designs = {};
  const DesignSpace space = combinations_.SpaceOf(combination);
  members_.push_back(
      {.combination = combination,
       .space = space,
       .search = std::make_unique<CombinationSearch>(space, metric_count_, options)});
  index_.emplace(combination, members_.size() - 1);
  return members_.size() - 1;
}

std::int64_t CombinedDiscovery::initial_samples() const {
  return std::min(static_cast<std::int64_t>(opening_.size()),
                  static_cast<std::int64_t>(members_.size() + others_.size() + 3) +
                      options_.initial_designs.cols());
}

std::optional<CombinedDiscovery::Proposal> CombinedDiscovery::Ask() {
  if (Finished()) return std::nullopt;
  const std::int64_t number = window_.proposed();
  const bool is_complete = others_.empty() && number == combinations_.count();
  if (window_.left() <= 0 || is_complete) {
    if (!CommitUpTo(number) || Finished()) return std::nullopt;
    if (is_complete) {
      Stop(StopReason::kConverged, absl::StrCat("all ", number, " designs were evaluated"));
    } else {
      Stop(StopReason::kBudget, absl::StrCat("all ", number, " evaluations were made"));
    }
    return std::nullopt;
  }
  if (number == static_cast<std::int64_t>(opening_.size())) window_.AwaitAll();
  if (!CommitUpTo(window_.needed()) || Finished()) return std::nullopt;
  std::optional<Next> next = NextDesign();
  if (!next) {
    // What is under way may open new ways; if nothing is, there are none.
    if (window_.committed() == number) {
      Stop(StopReason::kConverged, "every design that the method would try has been evaluated");
      return std::nullopt;
    }
    window_.AwaitAll();
    return Ask();
  }
  Proposal proposal{number, std::move(next->design.x)};
  ++members_[next->member].proposed;
  designs_.insert(Key(proposal.x));
  window_.Propose(proposal.x, {next->member, next->design.number});
  return proposal;
}

absl::Status CombinedDiscovery::Tell(std::int64_t number, Evaluation evaluation) {
  return window_.Tell(number, std::move(evaluation));
}

bool CombinedDiscovery::CommitUpTo(std::int64_t count) {
  return window_.CommitUpTo(count, [this](std::int64_t, Window::Proposed proposed) {
    Commit(std::move(proposed));
    return !Finished();
  });
}

void CombinedDiscovery::Commit(Window::Proposed proposed) {
  Evaluation& result = *proposed.result;
  ArchiveEntry added;
  added.u = space_.ToUnit(result.x);
  added.evaluated = IsUsable(result);
  if (added.evaluated) {
    added.metrics = result.metrics;
    added.constraints = result.constraints;
  } else {
    ++failed_;
    failures_.Add(FailureOf(result));
    if (message_.empty()) message_ = result.message;
  }
  const std::size_t entry = archive_.Add(std::move(added));
  member_of_.push_back(proposed.origin.member);
  evaluated_.push_back(result.x);
  deviations_.push_back(result.deviations);
  const double gain = Absorb(entry);
  gains_.push_back(gain);
  for (Member& each : members_) each.spent *= memory_;
  Member& member = members_[proposed.origin.member];
  member.entries.push_back(entry);
  member.spent += 1;
  member.search->Tell(proposed.origin.number, std::move(result));
  if (gain > 0) member.gap = std::min(member.gap, 0.0);
  if (member.stage == Stage::kPruned && !IsHopeless(member)) member.stage = Stage::kSearching;
}

// Puts an entry into the buffer; returns the hypervolume gained, in the scaling that holds
// afterwards.
double CombinedDiscovery::Absorb(std::size_t entry) {
  if (!archive_[entry].feasible) return 0;
  const Scaling scaling = archive_.CurrentScaling();
  if (buffer_.NeedsRebuild(scaling)) {
    buffer_.Rebuild(archive_, scaling);
  } else {
    buffer_.Insert(entry, buffer_.scaling().Apply(archive_[entry].metrics));
  }
  return archive_.non_dominated().back() == entry ? GainedVolume(archive_, buffer_.scaling(), entry)
                                                  : 0;
}

void CombinedDiscovery::Stop(StopReason reason, std::string message) {
  if (Finished()) return;
  CommitUpTo(window_.proposed());
  stop_ = reason;
  message_ = std::move(message);
  if (archive_.feasible_count() > 0) buffer_.Rebuild(archive_, archive_.CurrentScaling());
}

CombinedDiscovery::Summary CombinedDiscovery::summary() const {
  Summary summary;
  summary.stop_reason = stop_;
  summary.message = message_;
  summary.evaluations = window_.committed();
  summary.failed = failed_;
  summary.violating =
      static_cast<std::int64_t>(archive_.evaluated_count() - archive_.feasible_count());
  summary.failures = failures_.failures();
  summary.cells_covered = static_cast<std::int64_t>(buffer_.cells().size());
  summary.combinations = combinations_.count();
  summary.combinations_tried = 0;
  SurrogateTally surrogates;
  for (const Member& member : members_) {
    if (!member.entries.empty()) ++summary.combinations_tried;
    if (member.stage == Stage::kPruned) ++summary.combinations_pruned;
    summary.optimizations += member.search->Optimizations();
    summary.expansions += member.search->Expansions();
    summary.pieces += std::ssize(member.search->Pieces());
    surrogates.Add(member.search->Surrogates());
  }
  summary.surrogate = surrogates.quality();
  summary.hypervolume = shown_.At(archive_, window_.committed(), Finished());
  return summary;
}

absl::StatusOr<std::unique_ptr<AskTell>> MakeDiscovery(
    const DesignSpace& space, const std::vector<DiscreteParameter>& discrete,
    Eigen::Index metric_count, const Discovery::Options& options) {
  MORTISE_RETURN_IF_ERROR(pareto::Validate(discrete, space));
  const CombinationSpace combinations(space, discrete);
  if (combinations.count() > 1) {
    return CombinedDiscovery::Create(space, discrete, metric_count, options);
  }
  return Discovery::Create(combinations.SpaceOf(combinations.At(0)), metric_count, options);
}

}  // namespace mortise::pareto
