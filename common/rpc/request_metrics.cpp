#include "common/rpc/request_metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

namespace mortise::rpc {
namespace {

class NoMetrics : public RequestMetrics {
 public:
  void Begin() override {}
  void End(const std::string&, absl::StatusCode, absl::Duration) override {}
};

class PrometheusMetrics : public RequestMetrics {
 public:
  explicit PrometheusMetrics(std::shared_ptr<prometheus::Registry> registry)
      : registry_(std::move(registry)),
        requests_(prometheus::BuildCounter()
                      .Name("mortise_requests_total")
                      .Help("Calls answered, by method and code")
                      .Register(*registry_)),
        seconds_(prometheus::BuildHistogram()
                     .Name("mortise_request_seconds")
                     .Help("Time from a call's arrival to its answer")
                     .Register(*registry_)),
        in_flight_(prometheus::BuildGauge()
                       .Name("mortise_requests_in_flight")
                       .Help("Calls not answered yet")
                       .Register(*registry_)
                       .Add({})) {}

  void Begin() override { in_flight_.Increment(); }

  void End(const std::string& method, absl::StatusCode code, absl::Duration time) override {
    in_flight_.Decrement();
    requests_.Add({{"method", method}, {"code", absl::StatusCodeToString(code)}}).Increment();
    static const prometheus::Histogram::BucketBoundaries kBuckets = {
        0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 60};
    seconds_.Add({{"method", method}}, kBuckets).Observe(absl::ToDoubleSeconds(time));
  }

 private:
  const std::shared_ptr<prometheus::Registry> registry_;
  prometheus::Family<prometheus::Counter>& requests_;
  prometheus::Family<prometheus::Histogram>& seconds_;
  prometheus::Gauge& in_flight_;
};

}  // namespace

std::unique_ptr<RequestMetrics> RequestMetrics::Create(
    std::shared_ptr<prometheus::Registry> registry) {
  if (registry == nullptr) return std::make_unique<NoMetrics>();
  return std::make_unique<PrometheusMetrics>(std::move(registry));
}

}  // namespace mortise::rpc
