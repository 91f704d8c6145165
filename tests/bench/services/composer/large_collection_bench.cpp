// What connecting costs where the catalog has many designs: pieces of designs that ship are taken
// out, dropped a little off and snapped, and connected again by the connections of what ships, and
// of that many copies of it besides, each at other parameters. With their original design, and as
// if that were not known, so that all connections are looked for in the collection. Printed are the
// milliseconds of processor time that half and 99 of 100 take at most; wanted are 200 ms against
// what ships, and 400 ms against 50 copies.
// large_collection_bench [COPIES]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "services/composer/model/removal.h"
#include "services/composer/snapping/snap.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

constexpr std::size_t kMaxParts = 130;  // of a design of which a piece is taken out
constexpr double kMostJitter = 0.3;     // of the way to a random design that is feasible
constexpr int kPiecesOfEach = 3;        // of a design
constexpr double kMillisecond = 1e-3;   // s
constexpr double kDropped = 0.01;       // m off, along each axis, at most

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

// The connections of each copy of each design.
std::vector<std::vector<CollectionConnection>> JitteredCopies(int copies) {
  std::vector<std::vector<CollectionConnection>> made;
  std::mt19937_64 random(50);
  int unlike = 0;
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    Design design = ShippedDesign(id);
    const auto samples = design.assembly->Sample(copies, 50).value();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      // The feasible set is convex: what is between two of its members is one.
      const double share = kMostJitter * static_cast<double>(random() >> 11) * 0x1p-53;
      design.q = design.assembly->drawn() + share * (samples[i] - design.assembly->drawn());
      const absl::StatusOr<parametric::Assembly> drawn = DrawnAt(design);
      if (!drawn.ok()) {
        ++unlike;
        continue;
      }
      made.push_back(ConnectionsOf(absl::StrCat("assemblies/", id, "-", i), *drawn).value());
    }
  }
  if (unlike > 0) std::printf("%d copies cannot be drawn\n", unlike);
  return made;
}

struct Piece {
  std::string name;
  Design body, component;
  Original original;
};

// Pieces taken out of designs that ship, dropped beside their places and snapped.
std::vector<Piece> PiecesTakenOut() {
  std::vector<Piece> pieces;
  std::mt19937_64 random(29);
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    const Design& whole = ShippedDesign(id);
    if (PartsOf(whole).size() > kMaxParts) continue;
    std::vector<std::string> nodes = parametric::DistinctSubTrees(whole.assembly->assembly());
    for (const parametric::Element& element : whole.assembly->elements()) {
      if (!element.connecting) nodes.push_back(element.name);
    }
    for (int i = 0; i < kPiecesOfEach && !nodes.empty(); ++i) {
      const std::string node = nodes[random() % nodes.size()];
      absl::StatusOr<parametric::Assembly> rest = WithoutNode(whole, node);
      absl::StatusOr<Design> body = rest.ok() ? AsDrawn(*std::move(rest)) : rest.status();
      if (!body.ok()) continue;
      Design component = ShippedComponent(id, node);
      for (double& along : component.shift) {
        along = kDropped * (static_cast<double>(random() >> 11) * 0x1p-52 - 1);
      }
      absl::StatusOr<Snapped> snapped = Snap(component, &whole, *body);
      if (!snapped.ok()) continue;
      pieces.push_back({absl::StrCat(node, " of ", id), *std::move(body),
                        std::move(snapped->component), ShippedOriginal(id)});
    }
  }
  return pieces;
}

void Measure(const std::vector<Piece>& pieces, bool with_original, const std::string& against,
             const std::vector<const CollectionConnection*>& others) {
  const ConnectOptions options = ShippedOptions();
  std::vector<double> times;
  int connected = 0;
  double longest = 0;
  std::string slowest;
  for (const Piece& piece : pieces) {
    const double begin = ProcessorTime();
    connected += Connect(piece.body, piece.component, "new",
                         with_original ? &piece.original : nullptr, others, options)
                     .ok();
    times.push_back((ProcessorTime() - begin) / kMillisecond);
    if (times.back() <= longest) continue;
    longest = times.back();
    slowest = piece.name;
  }
  std::printf(
      "%-16s %-22s %7zu connections  %3zu pieces  %3d connected  p50 %7.1f ms  p99 %7.1f ms"
      "  longest %7.1f ms (%s)\n",
      with_original ? "original known" : "original unknown", against.c_str(), others.size(),
      pieces.size(), connected, At(times, 0.5), At(times, 0.99), longest, slowest.c_str());
  std::fflush(stdout);
}

void Run(int copies) {
  std::vector<const CollectionConnection*> all = AllShippedConnections();
  const std::vector<Piece> pieces = PiecesTakenOut();
  const double begin = ProcessorTime();
  const std::vector<std::vector<CollectionConnection>> jittered = JitteredCopies(copies);
  std::printf("%d copies of all that ships made in %.0f s\n", copies, ProcessorTime() - begin);
  std::vector<const CollectionConnection*> many = all;
  for (const std::vector<CollectionConnection>& copy : jittered) {
    for (const CollectionConnection& one : copy) many.push_back(&one);
  }
  for (const bool with_original : {true, false}) {
    Measure(pieces, with_original, "what ships", all);
    Measure(pieces, with_original, absl::StrCat("what ships, ", copies, " copies"), many);
  }
}

}  // namespace
}  // namespace mortise::composer

int main(int count, char** arguments) {
  const int copies = count > 1 ? std::atoi(arguments[1]) : 50;  // NOLINT: 0 is a number of copies
  if (copies < 1) {
    std::fprintf(stderr, "Usage: large_collection_bench [COPIES]\n");
    return 2;
  }
  mortise::composer::Run(copies);
}
