// An evaluator in the test's process that serves ZDT1 over gRPC.
#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {

inline constexpr int kDimensions = 5;

// Serves ZDT1 with its second metric negated as "gain", to be made large, a third, "stress" =
// 10 (0.7 - x0), "cost" = 5 (1 - x1), and "weight", which is nine times the first. Can be held up
// after a number of evaluations, and answer in ways that it should not.
class Zdt1Evaluator : public v1::EvaluatorService::Service {
 public:
  grpc::Status DescribeDesignSpace(grpc::ServerContext*,
                                   const v1::DescribeDesignSpaceRequest* request,
                                   v1::DesignSpace* response) override {
    if (request->subject() != "templates/zdt1" && request->subject() != "evaluators/mixed") {
      return {grpc::StatusCode::NOT_FOUND, "no such template"};
    }
    response->set_subject(request->subject());
    response->set_revision(3);
    for (int i = 0; i < kDimensions; ++i) {
      auto& parameter = *response->add_parameters();
      parameter.set_name("x" + std::to_string(i));
      parameter.set_maximum(1);
    }
    if (request->subject() == "evaluators/mixed") {
      // Only the second material and two ribs leave all of the front.
      auto& material = *response->mutable_parameters(3);
      for (const char* name : {"oak", "birch", "steel"}) material.add_choices(name);
      material.set_maximum(2);
      material.set_step(1);
      auto& ribs = *response->mutable_parameters(4);
      ribs.set_minimum(1);
      ribs.set_maximum(3);
      ribs.set_default_value(1);
      ribs.set_step(1);
    }
    for (const char* name : {"mass", "gain", "stress", "cost", "weight"}) {
      auto& metric = *response->add_metrics();
      metric.set_name(name);
      metric.set_unit("kg");
    }
    return grpc::Status::OK;
  }

  grpc::Status EvaluateBatch(grpc::ServerContext* context, const v1::EvaluateBatchRequest* request,
                             grpc::ServerWriter<v1::EvaluationResult>* writer) override {
    for (int k = 0; k < request->points_size(); ++k) {
      if (!Admit(*context)) return {grpc::StatusCode::CANCELLED, "cancelled"};
      if (lost_) return {grpc::StatusCode::INTERNAL, "the solver's licence has run out"};
      const auto& parameters = request->points(k).parameters();
      Eigen::VectorXd x = Eigen::VectorXd::Map(parameters.data(), parameters.size());
      if (request->subject() == "evaluators/mixed") {
        whole_ = whole_ && x.tail(2) == x.tail(2).array().round().matrix();
        x[3] = 0.3 * std::abs(x[3] - 1);
        x[4] = 0.2 * std::abs(x[4] - 2);
      }
      v1::EvaluationResult result;
      result.set_index(misnumbers_ ? 1000 : k);
      if (const absl::Status fault = FaultOf(x); !fault.ok()) {
        *result.mutable_error() = rpc::ToProto(fault);
      } else {
        const Evaluation evaluation = problem_.evaluate(x, false);
        for (const std::string& name : request->metrics()) {
          if (name == left_out_) continue;
          auto& metric = *result.add_metrics();
          metric.set_name(name);
          metric.set_unit("kg");
          metric.set_value(name == "mass"     ? evaluation.metrics[0] + drift_
                           : name == "weight" ? 9 * evaluation.metrics[0]
                           : name == "gain"   ? -evaluation.metrics[1]
                           : name == "cost"   ? 5 * (1 - x[1])
                                              : 10 * (0.7 - x[0]));
          if (name == useless_) metric.set_value(std::numeric_limits<double>::quiet_NaN());
        }
      }
      Note(x);
      writer->Write(result);
    }
    return grpc::Status::OK;
  }

  // Lets `count` evaluations pass, then holds the next ones until Release.
  void HoldAfter(int count) {
    const std::lock_guard lock(mutex_);
    limit_ = evaluations_ + count;
  }
  void Release() {
    const std::lock_guard lock(mutex_);
    limit_ = std::numeric_limits<int>::max();
    changed_.notify_all();
  }
  void WaitUntilHeld() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(60), [&] { return evaluations_ >= limit_; });
  }
  // Every design with a first parameter of at least `least` fails so from now on, but those whose
  // second is above `conflict`: they cannot be built at all.
  void FailFrom(double least, const absl::Status& fault, double conflict = 0.9) {
    const std::lock_guard lock(mutex_);
    conflicts_from_ = conflict;
    fails_from_ = least;
    fault_ = fault;
  }
  // Whether choices and whole numbers were whole.
  bool whole() const { return whole_; }
  // The designs evaluated since the last call.
  std::vector<Eigen::VectorXd> TakeEvaluated() {
    const std::lock_guard lock(mutex_);
    return std::exchange(evaluated_, {});
  }

  std::atomic<bool> lost_ = false;        // every call fails
  std::atomic<bool> misnumbers_ = false;  // answers are of designs that were not asked for
  std::atomic<double> drift_ = 0;         // of "mass"
  std::string left_out_;                  // a metric; set before it is asked
  std::string useless_;                   // a metric that is NaN; set before it is asked

  int evaluations() {
    const std::lock_guard lock(mutex_);
    return evaluations_;
  }

 private:
  absl::Status FaultOf(const Eigen::VectorXd& x) {
    const std::lock_guard lock(mutex_);
    if (x[1] > conflicts_from_) return InvalidField("points", "cannot be built");
    return x[0] >= fails_from_ ? fault_ : absl::OkStatus();
  }

  void Note(const Eigen::VectorXd& x) {
    const std::lock_guard lock(mutex_);
    evaluated_.push_back(x);
  }

  bool Admit(grpc::ServerContext& context) {
    std::unique_lock lock(mutex_);
    while (evaluations_ >= limit_) {
      if (context.IsCancelled()) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    ++evaluations_;
    changed_.notify_all();
    return true;
  }

  const BenchmarkProblem problem_ = *MakeBenchmarkProblem("ZDT1", kDimensions);
  std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> whole_ = true;
  std::vector<Eigen::VectorXd> evaluated_;
  int evaluations_ = 0;
  int limit_ = std::numeric_limits<int>::max();
  double conflicts_from_ = 0.9;
  double fails_from_ = 2;
  absl::Status fault_;
};

}  // namespace mortise::pareto
