#include "services/pareto/sources/population.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "services/pareto/archive/non_dominated.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kMemory = 0.98;         // weight of the past in how often a way is taken
constexpr double kCrossoverSpread = 15;  // distribution index: the larger, the nearer to parents
constexpr double kMutationSpread = 20;
constexpr double kMinShare = 0.15;  // of each way

double Crossover(double a, double b, Random& random) {
  const double share = random.Uniform();
  const double power = 1 / (kCrossoverSpread + 1);
  const double beta =
      share < 0.5 ? std::pow(2 * share, power) : std::pow(1 / (2 - 2 * share), power);
  return 0.5 * ((1 + beta) * a + (1 - beta) * b);
}

// Within [0, 1].
double Mutate(double u, Random& random) {
  const double share = random.Uniform();
  const double power = 1 / (kMutationSpread + 1);
  if (share < 0.5) {
    const double reach = std::pow(1 - u, kMutationSpread + 1);
    return u + std::pow(2 * share + (1 - 2 * share) * reach, power) - 1;
  }
  const double reach = std::pow(u, kMutationSpread + 1);
  return u + 1 - std::pow(2 * (1 - share) + (2 * share - 1) * reach, power);
}

VectorXd Crossed(const VectorXd& a, const VectorXd& b, Random& random) {
  VectorXd child = a;
  const double rate = 1 / static_cast<double>(a.size());
  for (Index i = 0; i < a.size(); ++i) {
    if (random.Uniform() < 0.5) child[i] = Crossover(a[i], b[i], random);
    child[i] = std::clamp(child[i], 0.0, 1.0);
    if (random.Uniform() < rate) child[i] = Mutate(child[i], random);
  }
  return child;
}

VectorXd Moved(const VectorXd& a, const VectorXd& b, const VectorXd& c, Random& random) {
  const double factor = random.Uniform() < 0.5 ? 1.0 : 0.3 + 0.6 * random.Uniform();
  const double rate = random.Uniform() < 0.5 ? 1.0 : random.Uniform();
  VectorXd child = a;
  const auto always = static_cast<Index>(random.Index(static_cast<std::size_t>(a.size())));
  for (Index i = 0; i < a.size(); ++i) {
    if (i != always && random.Uniform() >= rate) continue;
    const double moved = a[i] + factor * (b[i] - c[i]);
    // Beyond a bound, half of the way there.
    child[i] = moved < 0 ? 0.5 * a[i] : moved > 1 ? 0.5 * (a[i] + 1) : moved;
    if (moved < 0 && random.Uniform() < 0.5) child[i] = 0;
    if (moved > 1 && random.Uniform() < 0.5) child[i] = 1;
  }
  return child;
}

VectorXd Transplanted(const VectorXd& a, const VectorXd& b, Random& random) {
  VectorXd child = a;
  const std::size_t count = 1 + random.Index(2);
  for (std::size_t n = 0; n < count; ++n) {
    const auto i = static_cast<Index>(random.Index(static_cast<std::size_t>(a.size())));
    child[i] = random.Uniform() < 0.5 ? b[i] : random.Uniform();
  }
  return child;
}

}  // namespace

// The rank of each member is how many layers dominate it. What goes is of the last layer, and there
// nearest to another.
std::size_t Population::WorstOf(const Archive& archive, std::vector<int>& ranks) const {
  const std::size_t count = members_.size();
  std::vector<std::vector<std::size_t>> worse(count);
  std::vector<int> better(count, 0);
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      if (a == b || !Dominates(archive[members_[a]].metrics, archive[members_[b]].metrics)) {
        continue;
      }
      worse[a].push_back(b);
      ++better[b];
    }
  }
  ranks.assign(count, 0);
  std::vector<std::size_t> layer, last;
  for (std::size_t m = 0; m < count; ++m) {
    if (better[m] == 0) layer.push_back(m);
  }
  for (int rank = 0; !layer.empty(); ++rank) {
    last = layer;
    std::vector<std::size_t> next;
    for (const std::size_t a : layer) {
      ranks[a] = rank;
      for (const std::size_t b : worse[a]) {
        if (--better[b] == 0) next.push_back(b);
      }
    }
    layer = std::move(next);
  }
  VectorXd least = archive[members_[last[0]]].metrics, most = least;
  for (const std::size_t m : last) {
    least = least.cwiseMin(archive[members_[m]].metrics).eval();
    most = most.cwiseMax(archive[members_[m]].metrics).eval();
  }
  const VectorXd range = (most - least).cwiseMax(1e-300);
  std::size_t worst = last[0];
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::size_t a : last) {
    const VectorXd& y = archive[members_[a]].metrics;
    double distance = std::numeric_limits<double>::infinity();
    for (const std::size_t b : last) {
      if (a == b) continue;
      const VectorXd gap = (y - archive[members_[b]].metrics).cwiseQuotient(range);
      distance = std::min(distance, gap.squaredNorm());
    }
    // What is best in a metric stays.
    if (last.size() > 2 && ((y - least).array() <= 0).any()) distance += 1e3;
    if (distance < nearest) {
      nearest = distance;
      worst = a;
    }
  }
  return worst;
}

bool Population::Offer(const Archive& archive, std::size_t entry) {
  members_.push_back(entry);
  const std::size_t worst = WorstOf(archive, ranks_);
  if (members_.size() <= size_) return true;
  const bool stays = members_[worst] != entry;
  members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(worst));
  ranks_.erase(ranks_.begin() + static_cast<std::ptrdiff_t>(worst));
  return stays;
}

bool Population::Holds(std::size_t entry) const {
  return std::ranges::find(members_, entry) != members_.end();
}

void Population::Report(Way way, bool stayed) {
  const auto i = static_cast<std::size_t>(way);
  for (double& count : tried_) count *= kMemory;
  for (double& count : stayed_) count *= kMemory;
  tried_[i] += 1;
  stayed_[i] += stayed ? 1 : 0;
}

Population::Way Population::ChooseWay(Random& random) const {
  std::array<double, 3> share{};
  double total = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    share[i] = (stayed_[i] + 0.1) / (tried_[i] + 0.2);
    total += share[i];
  }
  double draw = random.Uniform();
  for (std::size_t i = 0; i < 2; ++i) {
    draw -= kMinShare + (1 - 3 * kMinShare) * share[i] / total;
    if (draw < 0) return static_cast<Way>(i);
  }
  return Way::kTransplant;
}

// The better of two.
std::size_t Population::Select(Random& random) const {
  const std::size_t a = random.Index(members_.size()), b = random.Index(members_.size());
  return members_[ranks_[b] < ranks_[a] ? b : a];
}

Population::Child Population::MakeChild(const Archive& archive, Random& random) const {
  const Way way = ChooseWay(random);
  const VectorXd& a = archive[Select(random)].u;
  const VectorXd& b = archive[Select(random)].u;
  switch (way) {
    case Way::kDifference: {
      const VectorXd& c = archive[members_[random.Index(members_.size())]].u;
      return {Moved(a, b, c, random), way};
    }
    case Way::kTransplant:
      return {Transplanted(a, b, random), way};
    default:
      return {Crossed(a, b, random), way};
  }
}

Breeding::Breeding(const Archive& archive, Population& population, int children, Random& random)
    : population_(population) {
  for (int n = 0; n < children; ++n) children_.push_back(population.MakeChild(archive, random));
}

std::optional<Eigen::VectorXd> Breeding::Ask(Archive&) {
  if (children_.empty()) return std::nullopt;
  Population::Child child = std::move(children_.front());
  children_.pop_front();
  asked_.push_back(child.way);
  return std::move(child.u);
}

void Breeding::Tell(Archive& archive, std::size_t entry) {
  const Population::Way way = asked_.front();
  asked_.pop_front();
  // The discovery has offered it before.
  population_.Report(way, archive[entry].feasible && population_.Holds(entry));
}

}  // namespace mortise::pareto
