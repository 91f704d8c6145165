// An evaluator in the test's process whose metrics are known functions.
#pragma once

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/interpolator/bar_files.h"

namespace mortise::interpolator {

// x in [0, 1], y in [10, 12], ribs 1, 2, 3 and a material: the metrics "mass" (kg) and "stress"
// (Pa).
inline double MassOf(double x, double y, double ribs = 1, double material = 0) {
  return std::sin(2 * x + 0.5) * std::exp(10 - y) + 0.25 * ribs + material;
}
inline double StressOf(double x, double y, double ribs = 1) {
  return 1e6 * (1 + x + (y - 10) / ribs);
}

// Serves "evaluators/bowl", and events that its revision has changed. Can be held up after a number
// of evaluations, and answer in ways that it should not.
class FunctionEvaluator : public v1::EvaluatorService::Service {
 public:
  grpc::Status DescribeDesignSpace(grpc::ServerContext*,
                                   const v1::DescribeDesignSpaceRequest* request,
                                   v1::DesignSpace* response) override {
    if (request->subject() != "evaluators/bowl") {
      return {grpc::StatusCode::NOT_FOUND, "no such evaluator"};
    }
    response->set_subject(request->subject());
    response->set_revision(revision_);
    Add(*response, "x", "m", 0, 1, 0.5);
    Add(*response, "y", "m", 10, 12, 11);
    Add(*response, "ribs", "1", 1, 3, 1).set_step(1);
    v1::DesignSpace::DesignParameter& material = Add(*response, "material", "1", 0, 2, 0);
    material.set_step(1);
    for (const char* name : {"oak", "birch", "steel"}) material.add_choices(name);
    for (const char* name : {"mass", "stress"}) {
      auto& metric = *response->add_metrics();
      metric.set_name(name);
      metric.set_unit(name == std::string("mass") ? "kg" : "Pa");
    }
    response->set_geometry(geometry_);
    for (const char* name : {"stress", "heat"}) {
      auto& field = *response->add_fields();
      field.set_name(name);
      field.set_unit(name == std::string("stress") ? "Pa" : "K");
      field.set_components(1);
      field.set_of_elements(name == std::string("heat"));
    }
    return grpc::Status::OK;
  }

  grpc::Status EvaluateBatch(grpc::ServerContext* context, const v1::EvaluateBatchRequest* request,
                             grpc::ServerWriter<v1::EvaluationResult>* writer) override {
    for (int k = 0; k < request->points_size(); ++k) {
      // As a server answers that is going away.
      if (!Admit(*context)) return {grpc::StatusCode::UNAVAILABLE, "it goes away"};
      if (lost_) return {grpc::StatusCode::INTERNAL, "the solver's licence has run out"};
      const auto& x = request->points(k).parameters();
      v1::EvaluationResult result;
      result.set_index(k);
      if (const absl::Status fault = FaultOf({x.begin(), x.end()}); !fault.ok()) {
        *result.mutable_error() = rpc::ToProto(fault);
      } else {
        for (const std::string& name : request->metrics()) {
          auto& metric = *result.add_metrics();
          metric.set_name(name);
          metric.set_value(name == "mass" ? MassOf(x[0], x[1], x[2], x[3])
                                          : StressOf(x[0], x[1], x[2]));
          if (not_finite_) metric.set_value(std::numeric_limits<double>::quiet_NaN());
        }
        if (request->has_design_fields()) {
          *result.mutable_design_fields() =
              files_.Put({x.begin(), x.end()}, request->design_fields());
        }
      }
      Note({x.begin(), x.end()});
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

  // Designs for which `fails` is true cannot be evaluated, for this reason.
  void Fail(std::function<bool(double x, double y)> fails, absl::Status fault) {
    const std::lock_guard lock(mutex_);
    fails_ = std::move(fails);
    fault_ = std::move(fault);
  }

  // How many evaluations there were; since Forget, of how many designs, how often one was evaluated
  // at most, and how many were more than once.
  int evaluations() {
    const std::lock_guard lock(mutex_);
    return evaluations_;
  }
  int designs() {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(counts_.size());
  }
  int most_of_one() {
    const std::lock_guard lock(mutex_);
    int most = 0;
    for (const auto& [design, count] : counts_) most = std::max(most, count);
    return most;
  }
  int asked_again() {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(
        std::ranges::count_if(counts_, [](const auto& counted) { return counted.second > 1; }));
  }
  void Forget() {
    const std::lock_guard lock(mutex_);
    counts_.clear();
  }

  std::atomic<bool> lost_ = false;        // every call fails
  std::atomic<bool> not_finite_ = false;  // every metric is NaN
  std::atomic<int> revision_ = 3;
  std::atomic<v1::GeometryKind> geometry_ = v1::TETRAHEDRA;

  // Where the shapes of designs are; the server of the test serves it, too.
  BarFiles& files() { return files_; }

 private:
  static v1::DesignSpace::DesignParameter& Add(v1::DesignSpace& space, const std::string& name,
                                               const std::string& unit, double minimum,
                                               double maximum, double value) {
    auto& parameter = *space.add_parameters();
    parameter.set_name(name);
    parameter.set_unit(unit);
    parameter.set_minimum(minimum);
    parameter.set_maximum(maximum);
    parameter.set_default_value(value);
    return parameter;
  }

  absl::Status FaultOf(const std::vector<double>& x) {
    const std::lock_guard lock(mutex_);
    return fails_ && fails_(x[0], x[1]) ? fault_ : absl::OkStatus();
  }

  void Note(const std::vector<double>& x) {
    const std::lock_guard lock(mutex_);
    ++counts_[x];
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

  BarFiles files_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::vector<double>, int> counts_;
  int evaluations_ = 0;
  int limit_ = std::numeric_limits<int>::max();
  std::function<bool(double, double)> fails_;
  absl::Status fault_;
};

// Events as the catalog and the simulator have them: Tell sends one to all who follow.
class ToldEvents : public v1::EventService::Service {
 public:
  grpc::Status FollowEvents(grpc::ServerContext* context, const v1::FollowEventsRequest*,
                            grpc::ServerWriter<v1::Event>* writer) override {
    std::unique_lock lock(mutex_);
    std::size_t told = events_.size();
    while (!context->IsCancelled()) {
      for (; told < events_.size(); ++told) writer->Write(events_[told]);
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    return grpc::Status::OK;
  }

  void Tell(const std::string& type, const std::string& subject) {
    const std::lock_guard lock(mutex_);
    v1::Event event;
    event.set_type(type);
    event.set_subject(subject);
    events_.push_back(event);
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<v1::Event> events_;
};

}  // namespace mortise::interpolator
