// Queries of the index over 60 families, and over 100 jittered copies of each: `us` a query for the
// ten nearest families, `growth` that over the time with 60, `scan_ratio` what looking at every
// primitive takes over it, `distances` from primitives of a query. Arguments: dimension (24: D2,
// one descriptor; 280: light field, four turns), primitives a family, copies, and whether queries
// are designs of a family with some noise (1) or shapes of no family (0).
#include <benchmark/benchmark.h>

#include <ctime>
#include <map>
#include <optional>
#include <tuple>

#include "services/retrieval/index/primitive_index.h"
#include "tests/unit/services/retrieval/index/random_covers.h"

namespace mortise::retrieval {
namespace {

// Of the processor, as others may want it at the same time.
double Seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
using Eigen::VectorXd;

constexpr double kJitter = 0.05;  // of the families' spread

struct Setting {
  std::vector<FamilyCover> families;
  PrimitiveIndex index;
};

Setting Make(int dimension, int primitives, int copies) {
  Random random(31);
  auto families =
      testing::RandomCovers({.primitives = primitives, .dimension = dimension}, &random);
  auto index = PrimitiveIndex::Build(testing::Jittered(families, copies, kJitter, &random));
  return {std::move(families), *std::move(index)};
}

std::vector<IndexQuery> Queries(const Setting& setting, int turns, bool near) {
  Random random(32);
  std::vector<IndexQuery> queries;
  const Eigen::Index size = setting.index.dimension();
  for (int i = 0; i < 64; ++i) {
    const FamilyCover& family = setting.families[static_cast<std::size_t>(60 * random.Uniform())];
    const Primitive& primitive = family.primitives[static_cast<std::size_t>(
        random.Uniform() * static_cast<double>(family.primitives.size()))];
    IndexQuery query{.descriptors = {}, .count = 10};
    query.descriptors.push_back(
        near ? VectorXd(primitive.center + 0.05 * testing::RandomDescriptor(size, &random))
             : testing::RandomDescriptor(size, &random));
    for (int turn = 1; turn < turns; ++turn) {
      query.descriptors.push_back(query.descriptors[0] +
                                  0.5 * testing::RandomDescriptor(size, &random));
    }
    queries.push_back(std::move(query));
  }
  return queries;
}

void BM_Query(benchmark::State& state) {
  static std::map<std::tuple<long, long, long>, double> of_one_copy;
  const int dimension = static_cast<int>(state.range(0));
  // Kept while it is asked again: making it takes far longer than asking.
  static std::tuple<long, long, long> made_of;
  static std::optional<Setting> made;
  const std::tuple wanted(state.range(0), state.range(1), state.range(2));
  if (made_of != wanted) {
    made.reset();
    made = Make(dimension, static_cast<int>(state.range(1)), static_cast<int>(state.range(2)));
    made_of = wanted;
  }
  const Setting& setting = *made;
  const auto queries = Queries(setting, dimension > 100 ? 4 : 1, state.range(3) == 1);
  std::size_t next = 0;
  long distances = 0, nodes = 0;
  const double begin = Seconds();
  for (auto _ : state) {
    IndexEffort effort;
    benchmark::DoNotOptimize(setting.index.Nearest(queries[next++ % queries.size()], &effort));
    distances += effort.distances;
    nodes += effort.nodes;
  }
  const double end = Seconds();
  const double each = (end - begin) / static_cast<double>(state.iterations());
  for (std::size_t i = 0; i < 4; ++i) {
    benchmark::DoNotOptimize(setting.index.LinearScan(queries[i]));
  }
  const double scan = (Seconds() - end) / 4;
  double& one = of_one_copy[{state.range(0), state.range(1), state.range(3)}];
  if (state.range(2) == 1) one = each;
  state.counters["us"] = 1e6 * each;
  state.counters["growth"] = one > 0 ? each / one : 0;
  state.counters["scan_ratio"] = scan / each;
  state.counters["distances"] =
      static_cast<double>(distances) / static_cast<double>(state.iterations());
  state.counters["nodes"] = static_cast<double>(nodes) / static_cast<double>(state.iterations());
  state.counters["primitives"] = static_cast<double>(setting.index.primitives());
}

BENCHMARK(BM_Query)
    ->ArgsProduct({{24, 280}, {20}, {1, 100}, {1, 0}})
    ->ArgsProduct({{24, 280}, {200}, {1}, {1, 0}});

}  // namespace
}  // namespace mortise::retrieval

BENCHMARK_MAIN();
