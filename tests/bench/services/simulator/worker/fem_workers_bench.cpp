// How much sooner two workers are done with finite elements than one, behind the gateway of a house
// as it is started by default: one thread for each.
#include <benchmark/benchmark.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <random>
#include <string>

#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/e2e/running_house.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPoints = 24;  // of a batch
constexpr char kSubject[] = "templates/wrench";
constexpr double kElementSize = 0.004;  // m: some 10,000 quadratic elements

// Points within the middle half of each parameter's range, others for each `seed`.
v1::EvaluateBatchRequest Batch(const v1::DesignSpace& space, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  v1::EvaluateBatchRequest request;
  request.set_subject(kSubject);
  request.add_metrics("max_von_mises");
  request.mutable_mesh()->set_element_size(kElementSize);
  for (int i = 0; i < kPoints; ++i) {
    v1::DesignPoint& point = *request.add_points();
    for (const v1::DesignSpace::DesignParameter& parameter : space.parameters()) {
      const double share = 0.25 + 0.5 * static_cast<double>(random() >> 11) * 0x1p-53;
      point.add_parameters(parameter.minimum() +
                           share * (parameter.maximum() - parameter.minimum()));
    }
  }
  return request;
}

// A house and who asks it.
class House {
 public:
  explicit House(int workers)
      : house_(workers),
        evaluators_(v1::EvaluatorService::NewStub(
            grpc::CreateChannel(house_.GrpcAddress(), grpc::InsecureChannelCredentials()))) {}

  // Seconds for a batch; negative if a point of it fails.
  double SecondsFor(std::uint64_t seed) {
    grpc::ClientContext describing;
    v1::DescribeDesignSpaceRequest describe;
    describe.set_subject(kSubject);
    v1::DesignSpace space;
    if (!evaluators_->DescribeDesignSpace(&describing, describe, &space).ok()) return -1;
    const auto start = Clock::now();
    grpc::ClientContext context;
    const auto reader = evaluators_->EvaluateBatch(&context, Batch(space, seed));
    v1::EvaluationResult result;
    int good = 0;
    while (reader->Read(&result)) good += result.has_error() ? 0 : 1;
    const bool is_done = reader->Finish().ok() && good == kPoints;
    return is_done ? std::chrono::duration<double>(Clock::now() - start).count() : -1;
  }

 private:
  const e2e::RunningHouse house_;
  const std::unique_ptr<v1::EvaluatorService::Stub> evaluators_;
};

void BM_TwoWorkersBesideOne(benchmark::State& state) {
  House one(1), two(2);
  // What is read and compiled once for all points.
  if (one.SecondsFor(1) < 0 || two.SecondsFor(1) < 0) return state.SkipWithError("a point failed");
  double alone = 0, together = 0;
  std::uint64_t seed = 2;
  for (auto unused : state) {
    const double first = one.SecondsFor(seed), second = two.SecondsFor(seed);
    ++seed;
    if (first < 0 || second < 0) return state.SkipWithError("a point failed");
    alone += first;
    together += second;
  }
  state.counters["one_s"] = alone / static_cast<double>(state.iterations());
  state.counters["two_s"] = together / static_cast<double>(state.iterations());
  state.counters["times_sooner"] = alone / together;
}
BENCHMARK(BM_TwoWorkersBesideOne)->Iterations(3)->UseRealTime()->Unit(benchmark::kSecond);

}  // namespace
}  // namespace mortise::simulator

BENCHMARK_MAIN();
