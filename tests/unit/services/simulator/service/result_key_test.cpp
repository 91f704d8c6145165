#include "services/simulator/service/result_key.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <vector>

namespace mortise::simulator {
namespace {

v1::Task Wanted() {
  v1::Task task;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "evaluator: 'simulator' digest: 'subject' point { parameters: 1 parameters: 2 } "
      "metrics: 'mass' metrics: 'volume' mesh { element_size: 0.1 } airflow { cells: 3000 }",
      &task));
  return task;
}

TEST(ResultKey, TellsApartWhateverAResultDependsOn) {
  const std::vector<std::function<void(v1::Task&)>> changes{
      [](v1::Task&) {},
      [](v1::Task& task) { task.set_digest("other"); },
      [](v1::Task& task) { task.mutable_point()->set_parameters(1, std::nextafter(2, 3)); },
      [](v1::Task& task) { task.mutable_point()->add_parameters(0); },
      [](v1::Task& task) { task.set_metrics(1, "compliance"); },
      [](v1::Task& task) { task.mutable_metrics()->SwapElements(0, 1); },
      [](v1::Task& task) { task.mutable_metrics()->RemoveLast(); },
      [](v1::Task& task) { task.set_gradients(true); },
      [](v1::Task& task) { task.mutable_mesh()->set_element_size(0.2); },
      [](v1::Task& task) { task.mutable_mesh()->set_linear(true); },
      [](v1::Task& task) { task.mutable_mesh()->set_relative_error(0.1); },
      [](v1::Task& task) { task.mutable_mesh()->set_size_scale(0.8); },
      [](v1::Task& task) { task.mutable_airflow()->set_cells(4000); },
      [](v1::Task& task) { task.mutable_design_fields()->set_geometry(v1::SURFACE); },
      [](v1::Task& task) { task.mutable_design_fields()->set_geometry(v1::TETRAHEDRA); },
      [](v1::Task& task) { task.mutable_design_fields()->add_fields("von_mises"); },
      [](v1::Task& task) { task.mutable_design_fields()->add_regions("von_mises"); },
      [](v1::Task& task) { task.mutable_design_fields()->set_position_step(1e-5); },
      [](v1::Task& task) {
        auto& own = *task.mutable_metric_definitions()->add_expressions();
        own.set_name("twice");
        own.set_expression("2 * mass");
      },
      [](v1::Task& task) { task.set_evaluator("evaluators/theirs"); },
  };
  std::set<std::string> keys;
  for (const auto& change : changes) {
    v1::Task task = Wanted();
    change(task);
    EXPECT_TRUE(keys.insert(ResultKey(task)).second) << task.ShortDebugString();
  }
}

TEST(ResultKey, ForgetsWhoAsksAndWhen) {
  v1::Task task = Wanted();
  task.mutable_mesh()->set_size_scale(1);
  task.set_trace_id("another");
  task.set_attempt(3);
  task.set_worker("somebody");
  EXPECT_EQ(ResultKey(task), ResultKey(Wanted()));
  v1::Task zero = Wanted(), negative = Wanted();
  zero.mutable_point()->set_parameters(0, 0.0);
  negative.mutable_point()->set_parameters(0, -0.0);
  EXPECT_EQ(ResultKey(zero), ResultKey(negative));
}

// Where a later version computes other numbers, what an earlier one stored is not found.
TEST(ResultKey, FindsNoResultsOfOlderPhysics) {
  v1::Task task = Wanted();
  EXPECT_NE(ResultKey(task, kPhysicsVersion), ResultKey(task, kPhysicsVersion - 1));
  EXPECT_NE(ResultKey(task, kPhysicsVersion), ResultKey(task, kPhysicsVersion + 1));
  task.set_evaluator("evaluators/theirs");
  EXPECT_EQ(ResultKey(task, kPhysicsVersion), ResultKey(task, kPhysicsVersion - 1));
}

}  // namespace
}  // namespace mortise::simulator
