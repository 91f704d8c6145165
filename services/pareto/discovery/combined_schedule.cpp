// Which combination gets the next evaluation, which are given up, and what they learn from each
// other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "services/pareto/discovery/combined_discovery.h"

namespace mortise::pareto {
namespace {

constexpr double kMinShare = 0.15;     // of all combinations together, more for nearer ones
constexpr double kMaxInAdvance = 0.5;  // evaluations
constexpr double kTransplants = 0.1;
constexpr double kTransplantsToOpen = 0.25;  // while there are combinations that were not opened
constexpr double kNear = 0.05;               // to the front, scaled performance
constexpr double kDoubt = 5;                 // evaluations that a combination brought nothing in
constexpr std::int64_t kChecks = 100;
constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr double kUnknownGap = 0.1;       // of what has found no design within the constraints
constexpr std::size_t kRestoration = 20;  // evaluations to find one in
constexpr double kOpeningDoubt = 0.3;     // of how far behind it may be when it has had its opening
constexpr double kLooks[] = {0.6, 0.9};   // of the budget
constexpr double kLookShare = 0.03;       // of the budget, for each
constexpr std::size_t kLookTransplants = 2;  // of a combination
constexpr std::int64_t kEvaluationsATransplant = 6;
constexpr std::size_t kMaxRungTransplants = 12;
constexpr std::size_t kMaxSources = 32;
constexpr std::size_t kMaxOnFront = 64;
constexpr std::size_t kLearntFrom = 300;  // evaluations
constexpr double kWorstLearnt = 3;        // scaled performance
constexpr std::size_t kTransplantedAtOnce = 4;
constexpr double kKnown = 0.7;         // of a gap that was found
constexpr double kTriedBefore = 0.03;  // scaled performance that each transplant before counts

// How far `y` is behind `front`: by how much some point of that is better in every metric, or a
// third of by how much in one if it is worse in none (as Archive::ClearlyDominated); 0 or less
// where `y` is not dominated.
double Gap(const Eigen::VectorXd& y, const std::vector<Eigen::VectorXd>& front) {
  double gap = -kNowhere;
  for (const Eigen::VectorXd& point : front) {
    const double least = (y - point).minCoeff();
    gap = std::max(gap, least < 0 ? least : std::max(least, (y - point).maxCoeff() / 3));
  }
  return gap;
}

// Keeps at most `most` entries, evenly spread, among them the first and the last.
std::vector<std::size_t> Thinned(const std::vector<std::size_t>& entries, std::size_t most) {
  if (entries.size() <= most || most < 2) {
    return {entries.begin(),
            entries.begin() + static_cast<std::ptrdiff_t>(std::min(most, entries.size()))};
  }
  std::vector<std::size_t> thinned;
  for (std::size_t i = 0; i < most; ++i) {
    thinned.push_back(entries[i * (entries.size() - 1) / (most - 1)]);
  }
  return thinned;
}

}  // namespace

Eigen::VectorXd CombinedDiscovery::OthersOf(std::size_t entry) const {
  return archive_[entry].u(others_);
}

// Entries to learn from, along the merged front; while nothing is feasible those nearest to the
// constraints. None of `without`.
std::vector<std::size_t> CombinedDiscovery::Sources(const Member* without, std::size_t most) const {
  std::vector<std::size_t> sources;
  const auto is_other = [&](std::size_t entry) {
    return without == nullptr || &members_[member_of_[entry]] != without;
  };
  if (archive_.feasible_count() > 0) {
    std::ranges::copy_if(archive_.non_dominated(), std::back_inserter(sources), is_other);
    std::ranges::stable_sort(sources, [&](std::size_t a, std::size_t b) {
      return archive_[a].metrics[0] < archive_[b].metrics[0];
    });
    return Thinned(sources, most);
  }
  for (std::size_t entry = 0; entry < archive_.size(); ++entry) {
    if (archive_[entry].evaluated && is_other(entry)) sources.push_back(entry);
  }
  std::ranges::stable_sort(sources, {},
                           [&](std::size_t entry) { return archive_.Violation(entry); });
  if (sources.size() > most) sources.resize(most);
  return sources;
}

CombinationModel CombinedDiscovery::LearntModel() const {
  const Scaling scaling = archive_.CurrentScaling();
  std::vector<CombinationModel::Sample> samples;
  for (std::size_t entry = archive_.size(); entry-- > 0 && samples.size() < kLearntFrom;) {
    if (!archive_[entry].evaluated) continue;
    const Eigen::VectorXd y = scaling.Apply(archive_[entry].metrics);
    samples.push_back(
        {&members_[member_of_[entry]].combination, OthersOf(entry), y.cwiseMin(kWorstLearnt)});
  }
  return {combinations_.discrete(), samples};
}

// The design of an entry with a combination's discrete values.
Eigen::VectorXd CombinedDiscovery::Transplanted(std::size_t source, const Member& member) const {
  return member.space.FromUnit(archive_[source].u);
}

// Up to `most` new designs: half of them where the model expects most, the others along the front.
std::vector<Eigen::VectorXd> CombinedDiscovery::Transplants(const Member& member,
                                                            std::size_t most) {
  if (most == 0 || archive_.evaluated_count() == 0) return {};
  const std::vector<std::size_t> sources = Sources(&member, kMaxSources);
  if (sources.empty()) return {};
  const Scaling scaling = archive_.CurrentScaling();
  const CombinationModel model = LearntModel();
  std::vector<Eigen::VectorXd> front;
  for (const std::size_t entry : Sources(nullptr, kMaxOnFront)) {
    front.push_back(scaling.Apply(archive_[entry].metrics));
  }
  std::vector<std::pair<double, std::size_t>> expected;
  for (const std::size_t source : sources) {
    const Eigen::VectorXd y =
        scaling.Apply(archive_[source].metrics) +
        model.Difference(members_[member_of_[source]].combination, member.combination);
    expected.emplace_back(Gap(y, front), source);
  }
  std::ranges::sort(expected);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < expected.size() && i < (most + 1) / 2; ++i) {
    order.push_back(expected[i].second);
  }
  for (const std::size_t source : Thinned(sources, std::max<std::size_t>(most, 2))) {
    order.push_back(source);
  }
  for (const auto& [gap, source] : expected) order.push_back(source);
  std::vector<Eigen::VectorXd> designs;
  std::set<std::vector<double>> chosen;
  for (const std::size_t source : order) {
    if (designs.size() == most) break;
    const Eigen::VectorXd x = Transplanted(source, member);
    const std::vector<double> key(x.begin(), x.end());
    if (!designs_.contains(key) && chosen.insert(key).second) designs.push_back(x);
  }
  return designs;
}

std::optional<CombinedDiscovery::Next> CombinedDiscovery::NextDesign() {
  if (window_.proposed() < static_cast<std::int64_t>(opening_.size())) {
    return opening_[static_cast<std::size_t>(window_.proposed())];
  }
  if (!std::exchange(opened_, true)) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      members_[i].spent = 0;
      order.emplace_back(GapOf(members_[i], members_[i].entries.size()), i);
    }
    std::ranges::sort(order);
    for (const auto& [gap, member] : order) to_open_.push_back(member);
  }
  Prune();
  LookAgain();
  while (!looks_.empty()) {
    const std::size_t member = looks_.front();
    if (auto design = members_[member].search->AskQueued()) return Next{member, *std::move(design)};
    looks_.pop_front();
  }
  if (!to_open_.empty()) {
    std::size_t member = 0;
    if (auto design = AskOpening(member)) return Next{member, *std::move(design)};
    if (!to_open_.empty()) return std::nullopt;
  }
  if (std::optional<Next> next = AskShared()) return next;
  if (!Searching().empty() || others_.empty()) return std::nullopt;
  for (Member& member : members_) {
    if (member.stage == Stage::kPruned) member.stage = Stage::kSearching;
  }
  return AskShared();
}

std::vector<std::size_t> CombinedDiscovery::Searching() const {
  std::vector<std::size_t> searching;
  if (others_.empty()) return searching;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].stage == Stage::kSearching && !members_[i].search->exhausted()) {
      searching.push_back(i);
    }
  }
  return searching;
}

// Of each member, and at the end of transplants.
std::vector<double> CombinedDiscovery::Shares(const std::vector<std::size_t>& members) const {
  std::vector<double> gains(members_.size(), 0.0), rates, near;
  for (const std::size_t entry : archive_.non_dominated()) {
    gains[member_of_[entry]] +=
        gains_[entry] * std::pow(memory_, static_cast<double>(archive_.size() - 1 - entry));
  }
  for (const std::size_t i : members) {
    const Member& member = members_[i];
    rates.push_back(gains[i] / (member.spent + kDoubt));
    const double gap = member.gap < kNowhere ? std::max(member.gap, 0.0) : kUnknownGap;
    near.push_back(1 / (1 + std::pow(gap / kNear, 2)));
  }
  const double sum = std::accumulate(rates.begin(), rates.end(), 0.0);
  const double nearness = std::accumulate(near.begin(), near.end(), 0.0);
  const bool more = static_cast<std::int64_t>(members_.size()) < combinations_.count();
  const double transplants = more ? kTransplantsToOpen : kTransplants;
  const double least = sum > 0 ? kMinShare : 1 - transplants;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    rates[k] =
        (sum > 0 ? (1 - least - transplants) * rates[k] / sum : 0) + least * near[k] / nearness;
  }
  rates.push_back(transplants);
  return rates;
}

// From whom is owed most and has a design. While results are under way nobody gets much more than
// its share because others wait for them: it is better to wait as well.
std::optional<CombinedDiscovery::Next> CombinedDiscovery::AskShared() {
  const std::vector<std::size_t> members = Searching();
  const std::vector<double> shares = Shares(members);
  const auto owed = [&](std::size_t k) -> double& {
    return k == members.size() ? transplant_owed_ : members_[members[k]].owed;
  };
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k <= members.size(); ++k) order.emplace_back(-owed(k) - shares[k], k);
  std::ranges::sort(order);
  std::optional<Next> next;
  for (const auto& [less, k] : order) {
    if (less > kMaxInAdvance && !window_.under_way().empty()) break;
    if (k == members.size()) {
      next = AskTransplant();
    } else if (auto design = AskOf(members_[members[k]])) {
      next = Next{members[k], *std::move(design)};
    }
    if (!next) continue;
    for (std::size_t other = 0; other <= members.size(); ++other) {
      owed(other) = std::min(owed(other) + shares[other], static_cast<double>(options_.window));
    }
    owed(k) -= 1;
    break;
  }
  return next;
}

// Of the first combination in its opening that has a design.
std::optional<CombinationSearch::Design> CombinedDiscovery::AskOpening(std::size_t& member) {
  for (auto at = to_open_.begin(); at != to_open_.end();) {
    Member& opened = members_[*at];
    member = *at;
    if (opened.proposed < opening_evaluations_) {
      if (auto design = AskOf(opened)) return design;
    }
    if (opened.proposed >= opening_evaluations_ || opened.search->exhausted() || others_.empty()) {
      opened.stage = Stage::kSearching;
      at = to_open_.erase(at);
    } else {
      ++at;
    }
  }
  return std::nullopt;
}

std::optional<CombinationSearch::Design> CombinedDiscovery::AskOf(Member& member) {
  while (!member.search->exhausted()) {
    if (auto design = member.search->Ask()) return design;
    if (!member.search->IsIdle() || !PlanFor(member)) return std::nullopt;
  }
  return std::nullopt;
}

// What a combination does next; false if that is nothing.
bool CombinedDiscovery::PlanFor(Member& member) {
  const std::int64_t left = options_.evaluations - window_.proposed();
  std::int64_t evaluations = opening_evaluations_ - member.proposed;
  std::size_t transplants = transplants_;
  if (member.stage != Stage::kOpening) {
    const std::vector<std::size_t> members = Searching();
    const std::vector<double> shares = Shares(members);
    double share = 1;
    for (std::size_t k = 0; k < members.size(); ++k) {
      if (&members_[members[k]] == &member) share = shares[k];
    }
    evaluations = std::max({2 * member.search->last_plan(),
                            2 * (static_cast<std::int64_t>(others_.size()) + 2),
                            static_cast<std::int64_t>(share * static_cast<double>(left))});
    evaluations = std::min(evaluations, left);
    transplants = std::min(kMaxRungTransplants,
                           static_cast<std::size_t>(evaluations / kEvaluationsATransplant));
  }
  if (evaluations <= 0 || others_.empty()) return false;
  const std::vector<Eigen::VectorXd> designs = Transplants(member, transplants);
  member.search->Try(designs);
  evaluations -= static_cast<std::int64_t>(designs.size());
  member.search->Plan(std::max<std::int64_t>(evaluations, 0));
  return evaluations > 0 || !designs.empty();
}

// A design of the front with other discrete values: most often one of them, as those of most others
// that are as good are known already.
std::optional<CombinedDiscovery::Next> CombinedDiscovery::AskTransplant() {
  if (transplanted_.empty() && archive_.evaluated_count() > 0) ChooseTransplants();
  if (transplanted_.empty()) return std::nullopt;
  const auto [combination, x] = transplanted_.front();
  transplanted_.pop_front();
  const auto known = index_.find(combination);
  std::size_t member = 0;
  if (known == index_.end()) {
    member = AddMember(combination);
    members_[member].stage = Stage::kSearching;
  } else {
    member = known->second;
  }
  ++members_[member].transplants;
  return Next{member, members_[member].search->TryNow(x)};
}

// Where the model expects most, but for one in so many at random.
void CombinedDiscovery::ChooseTransplants() {
  const std::vector<std::size_t> sources = Sources(nullptr, kMaxSources);
  const Scaling scaling = archive_.CurrentScaling();
  const CombinationModel model = LearntModel();
  std::vector<Eigen::VectorXd> front;
  for (const std::size_t entry : Sources(nullptr, kMaxOnFront)) {
    front.push_back(scaling.Apply(archive_[entry].metrics));
  }
  struct Candidate {
    double score = 0;
    Combination combination;
    Eigen::VectorXd x;
  };
  std::vector<Candidate> candidates;
  const auto offer = [&](std::size_t source, const Combination& combination) {
    const Combination& from = members_[member_of_[source]].combination;
    if (combination == from) return;
    Eigen::VectorXd x = combinations_.SpaceOf(combination).FromUnit(archive_[source].u);
    if (designs_.contains({x.begin(), x.end()})) return;
    const auto known = index_.find(combination);
    const Member* const member = known == index_.end() ? nullptr : &members_[known->second];
    const Eigen::VectorXd y =
        scaling.Apply(archive_[source].metrics) + model.Difference(from, combination);
    double expected = Gap(y, front);
    // What is known of it counts more than what the model thinks of all.
    if (member != nullptr) {
      expected = std::max(expected, kKnown * std::min(member->gap, 1.0)) +
                 kTriedBefore * member->transplants;
    }
    candidates.push_back({expected, combination, std::move(x)});
  };
  for (const std::size_t source : sources) {
    const Combination& from = members_[member_of_[source]].combination;
    for (const Combination& neighbour : combinations_.Neighbours(from)) offer(source, neighbour);
    const std::size_t other = sources[random_.Index(sources.size())];
    Combination mixed = from;
    for (std::size_t k = 0; k < mixed.size(); ++k) {
      if (random_.Uniform() < 0.5) mixed[k] = members_[member_of_[other]].combination[k];
    }
    offer(source, mixed);
    const double any = random_.Uniform() * static_cast<double>(combinations_.count());
    offer(source, combinations_.At(static_cast<std::int64_t>(any)));
  }
  if (candidates.empty()) return;
  std::swap(candidates.front(), candidates[random_.Index(candidates.size())]);
  std::stable_sort(candidates.begin() + 1, candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  std::set<Combination> chosen;
  for (const Candidate& candidate : candidates) {
    if (chosen.size() == kTransplantedAtOnce) break;
    if (chosen.insert(candidate.combination).second) {
      transplanted_.emplace_back(candidate.combination, candidate.x);
    }
  }
}

// How far the nearest of a combination's first `count` designs is behind the merged front, scaled
// performance: 0 or less for one that nothing dominates; kNowhere where none meets the constraints.
double CombinedDiscovery::GapOf(const Member& member, std::size_t count) const {
  double least = kNowhere;
  if (archive_.feasible_count() == 0) return least;
  const Scaling scaling = archive_.CurrentScaling();
  std::vector<Eigen::VectorXd> front;
  for (const std::size_t entry : archive_.non_dominated()) {
    front.push_back(scaling.Apply(archive_[entry].metrics));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const ArchiveEntry& entry = archive_[member.entries[i]];
    if (entry.feasible) least = std::min(least, Gap(scaling.Apply(entry.metrics), front));
  }
  return least;
}

// The gap when it had no more than `count` entries, as it was found then; the latest without one.
double CombinedDiscovery::EarlierGap(const Member& member, std::size_t count) const {
  double gap = member.gap;
  for (const auto& [entries, then] : member.gaps) {
    if (entries <= count) gap = then;
  }
  return gap;
}

bool CombinedDiscovery::IsHopeless(const Member& member) const {
  const std::size_t count = member.entries.size();
  const double gap = GapOf(member, count);
  const auto opening = static_cast<std::size_t>(opening_evaluations_);
  if (gap == kNowhere) {
    const bool all_failed = std::ranges::none_of(
        member.entries, [&](std::size_t entry) { return archive_[entry].evaluated; });
    if (all_failed) return archive_.evaluated_count() > 0;
    return archive_.feasible_count() > 0 && count >= opening + kRestoration;
  }
  // Against the front as it was then, so that what follows the front at a distance has none.
  const double trend = EarlierGap(member, std::max(count / 2, opening)) - gap;
  const double doubt =
      kOpeningDoubt * static_cast<double>(opening) / static_cast<double>(std::max(count, opening));
  return gap - trend > std::max(2 * options_.delta_b, doubt);
}

// Now and then, as the front moves.
void CombinedDiscovery::Prune() {
  if (others_.empty() || window_.committed() < next_check_) return;
  next_check_ = window_.committed() + std::max<std::int64_t>(1, options_.evaluations / kChecks);
  for (const std::size_t i : Searching()) {
    Member& member = members_[i];
    member.gap = GapOf(member, member.entries.size());
    if (member.gaps.empty() || member.gaps.back().first < member.entries.size()) {
      member.gaps.emplace_back(member.entries.size(), member.gap);
    }
    if (static_cast<std::int64_t>(member.entries.size()) >= opening_evaluations_ &&
        IsHopeless(member)) {
      member.stage = Stage::kPruned;
    }
  }
}

void CombinedDiscovery::LookAgain() {
  if (looked_ >= static_cast<int>(std::size(kLooks)) || archive_.feasible_count() == 0 ||
      static_cast<double>(window_.proposed()) <
          kLooks[looked_] * static_cast<double>(options_.evaluations)) {
    return;
  }
  ++looked_;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].stage == Stage::kPruned) {
      order.emplace_back(GapOf(members_[i], members_[i].entries.size()), i);
    }
  }
  std::ranges::sort(order);
  auto left =
      static_cast<std::size_t>(std::ceil(kLookShare * static_cast<double>(options_.evaluations)));
  for (const auto& [gap, i] : order) {
    const std::vector<Eigen::VectorXd> designs =
        Transplants(members_[i], std::min(left, kLookTransplants));
    members_[i].search->Try(designs);
    if (!designs.empty()) looks_.push_back(i);
    left -= designs.size();
    if (left == 0) break;
  }
}

}  // namespace mortise::pareto
