// What suggestions cost: of designs that ship a piece is taken out, and what might come next is
// looked for in all that ships, as it is drawn and turned about the vertical. By itself, with the
// trials of the first twelve, and the same with a deadline. Printed are the milliseconds of
// processor time that half and 99 of 100 take at most, how many suggestions were tried and fit, and
// how far the slowest went past the deadline. Designs are parametrised before, as they are in a
// service after the first calls.
// suggest_bench [SECONDS]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "services/composer/model/quarter_turn.h"
#include "services/composer/model/removal.h"
#include "services/composer/suggestions/patience.h"
#include "services/composer/suggestions/suggest.h"
#include "services/composer/suggestions/try_suggestion.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

constexpr std::size_t kMaxParts = 130;  // of a design of which a piece is taken out
constexpr int kPiecesOfEach = 3;        // of a design
constexpr double kMillisecond = 1e-3;   // s

double ProcessorTime() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double At(std::vector<double> times, double share) {
  std::sort(times.begin(), times.end());
  const auto place = static_cast<std::size_t>(share * static_cast<double>(times.size()));
  return times[std::min(place, times.size() - 1)];
}

std::string IdOf(const std::string& assembly) {
  std::string id = assembly.substr(assembly.find('/') + 1);
  std::replace(id.begin(), id.end(), '-', '_');
  return id;
}

// Designs of what ships turned, with their connections, each made once.
const Original& ShippedTurned(const std::string& id, const std::vector<Axis>& turns) {
  static auto* const known = new std::map<std::pair<std::string, std::vector<Axis>>, Original>();
  const std::pair key(id, turns);
  if (const auto found = known->find(key); found != known->end()) return found->second;
  if (turns.empty()) return known->emplace(key, ShippedOriginal(id)).first->second;
  Original original;
  original.source = absl::StrCat("assemblies/", id);
  const parametric::Assembly turned = Turned(ShippedDesign(id).assembly->assembly(), TurnOf(turns));
  original.design = AsDrawn(turned).value();
  original.connections = std::make_shared<const std::vector<CollectionConnection>>(
      ConnectionsOf(original.source, turned).value());
  return known->emplace(key, std::move(original)).first->second;
}

// Pieces of these, each made once.
const Design& PieceOf(const std::string& id, const std::string& node,
                      const std::vector<Axis>& turns) {
  static auto* const known =
      new std::map<std::pair<std::string, std::pair<std::string, std::vector<Axis>>>, Design>();
  const std::pair key(id, std::pair(node, turns));
  if (const auto found = known->find(key); found != known->end()) return found->second;
  const parametric::Assembly& whole = ShippedTurned(id, turns).design.assembly->assembly();
  return known->emplace(key, AsDrawn(parametric::SubTreeOf(whole, node).value()).value())
      .first->second;
}

absl::StatusOr<const parametric::Assembly*> ShippedSubTree(const std::string& assembly,
                                                           const std::string& node) {
  return &PieceOf(IdOf(assembly), node, {}).assembly->assembly();
}

std::vector<Design> DesignsWithoutAPiece() {
  std::vector<Design> bodies;
  std::mt19937_64 random(29);
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    const Design& whole = ShippedDesign(id);
    if (PartsOf(whole).size() > kMaxParts) continue;
    std::vector<std::string> nodes = parametric::DistinctSubTrees(whole.assembly->assembly());
    for (const parametric::Element& element : whole.assembly->elements()) {
      if (!element.connecting) nodes.push_back(element.name);
    }
    for (int i = 0; i < kPiecesOfEach && !nodes.empty(); ++i) {
      absl::StatusOr<parametric::Assembly> rest =
          WithoutNode(whole, nodes[random() % nodes.size()]);
      absl::StatusOr<Design> body = rest.ok() ? AsDrawn(*std::move(rest)) : rest.status();
      if (body.ok()) bodies.push_back(*std::move(body));
    }
  }
  return bodies;
}

class SuggestBench {
 public:
  SuggestBench() : connections_(AllShippedConnections()), connecting_(ShippedOptions()) {
    options_.same_material = [this](const std::string& item, const std::string& other) {
      return item == other || connecting_.material_of(item) == connecting_.material_of(other);
    };
    for (int quarters = 0; quarters < 4; ++quarters) {
      options_.turns.resize(static_cast<std::size_t>(quarters) + 1);
      options_.turns.back() =
          TurnOf(std::vector<Axis>(static_cast<std::size_t>(quarters), Axis::kZ));
    }
  }

  // Infinite for no deadline, none for no trials.
  void Measure(const std::vector<Design>& bodies, const std::string& name,
               absl::Duration patience) {
    std::vector<double> times;
    int suggested = 0, tried = 0, fit = 0;
    absl::Duration latest = -absl::InfiniteDuration();
    for (const Design& body : bodies) {
      const absl::Time deadline = absl::Now() + patience;
      const double begin = ProcessorTime();
      for (const Suggestion& each : Suggestions(body, patience, deadline)) {
        using enum SuggestionTrial::Outcome;
        ++suggested;
        tried += each.trial.outcome != kNotTried;
        fit += each.trial.outcome == kFits;
      }
      times.push_back((ProcessorTime() - begin) / kMillisecond);
      latest = std::max(latest, absl::Now() - deadline);
    }
    std::printf(
        "%-14s %3zu models  p50 %8.1f ms  p99 %8.1f ms  %4d suggestions, %4d of them tried, %4d "
        "fit",
        name.c_str(), bodies.size(), At(times, 0.5), At(times, 0.99), suggested, tried, fit);
    if (patience > absl::ZeroDuration() && patience < absl::InfiniteDuration()) {
      std::printf("  the slowest ended %.0f ms after its deadline",
                  absl::ToDoubleMilliseconds(latest));
    }
    std::printf("\n");
    std::fflush(stdout);
  }

 private:
  std::vector<Suggestion> Suggestions(const Design& body, absl::Duration patience,
                                      absl::Time deadline) {
    SuggestOptions options = options_;
    Patience left(deadline, [] { return absl::Now(); });
    if (patience > absl::ZeroDuration()) {
      options.has_time = [&] { return left.HasTimeForTrial(); };
      options.trial = [&](const Suggestion& suggestion) {
        SuggestionTrial trial;
        left.Try([&] { trial = Try(body, suggestion); });
        return trial;
      };
    }
    return Suggest(body, connections_, ShippedSubTree, options);
  }

  SuggestionTrial Try(const Design& body, const Suggestion& suggestion) {
    const std::string id = IdOf(suggestion.from->source);
    const Original& original = ShippedTurned(id, suggestion.turns);
    Design dropped = PieceOf(id, suggestion.node, suggestion.turns);
    const parametric::BoundingBox box = BoundsOf(dropped);
    dropped.shift +=
        suggestion.position - Eigen::Vector3d(box.center().x(), box.center().y(), box.minimum.z());
    std::vector<const CollectionConnection*> others = connections_;
    if (!suggestion.turns.empty()) {
      for (const CollectionConnection& one : *original.connections) others.push_back(&one);
    }
    return TryComponent(body, dropped, suggestion.node, &original, others, connecting_);
  }

  const std::vector<const CollectionConnection*> connections_;
  const ConnectOptions connecting_;
  SuggestOptions options_;
};

}  // namespace
}  // namespace mortise::composer

int main(int count, char** arguments) {
  const double seconds = count > 1 ? std::atof(arguments[1]) : 1;  // NOLINT: 0 is refused
  if (seconds <= 0) {
    std::fprintf(stderr, "Usage: suggest_bench [SECONDS]\n");
    return 2;
  }
  const auto bodies = mortise::composer::DesignsWithoutAPiece();
  mortise::composer::SuggestBench bench;
  bench.Measure(bodies, "found", absl::ZeroDuration());
  bench.Measure(bodies, "first tried", absl::InfiniteDuration());  // which makes what is kept
  bench.Measure(bodies, "tried", absl::InfiniteDuration());
  bench.Measure(bodies, absl::StrCat("tried in ", seconds, " s"), absl::Seconds(seconds));
}
