// Resources of any kind as a table for people.
#include "cli/client/resource_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "mortise/v1/fabplanner.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "mortise/v1/pareto.pb.h"

namespace mortise::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

v1::Front SomeFront() {
  v1::Front front;
  front.set_name("fronts/1");
  front.mutable_specification()->set_subject("templates/table");
  front.set_creator("users/ada");
  front.add_external_ids("100-4711/A");
  front.add_external_ids("2");
  (*front.mutable_labels())["order"] = "17";
  (*front.mutable_labels())["customer"] = "acme";
  front.mutable_create_time()->set_seconds(90);
  return front;
}

std::string Printed(const ResourceTable& table) {
  testing::internal::CaptureStdout();
  table.Print(Output(Output::Form::kText));
  return testing::internal::GetCapturedStdout();
}

TEST(ResourceTable, ShowsWhatEveryResourceHas) {
  ResourceTable table(absl::FixedTimeZone(3600));
  table.Add(*FindKind("fronts"), SomeFront());
  v1::WorkOrder order;
  order.set_name("workOrders/2");
  order.set_plan("plans/3");
  order.set_state(v1::WorkOrder::IN_PROGRESS);
  table.Add(*FindKind("workOrders"), order);
  const std::string text = Printed(table);
  for (const char* const cell :
       {"fronts/1", "templates/table", "users/ada", "100-4711/A, 2", "customer=acme, order=17",
        "1970-01-01 01:01", "workOrders/2", "plans/3", "in-progress"}) {
    EXPECT_THAT(text, HasSubstr(cell));
  }
}

TEST(ResourceTable, LeavesOutWhatNoneHas) {
  ResourceTable table(absl::UTCTimeZone());
  v1::Front front = SomeFront();
  front.clear_external_ids();
  table.Add(*FindKind("fronts"), front);
  const std::string text = Printed(table);
  EXPECT_THAT(text, HasSubstr("labels"));
  EXPECT_THAT(text, Not(HasSubstr("external ids")));
  EXPECT_THAT(text, Not(HasSubstr("state")));
}

TEST(ResourceTable, SaysWhichMapsHaveShapes) {
  v1::DesignMap plain;
  plain.set_name("maps/plain");
  ResourceTable table(absl::UTCTimeZone());
  table.Add(*FindKind("maps"), plain);
  EXPECT_THAT(Printed(table), Not(HasSubstr("shapes")));
  v1::DesignMap shaped;
  shaped.set_name("maps/shaped");
  shaped.mutable_shapes()->set_geometry(v1::TETRAHEDRA);
  table.Add(*FindKind("maps"), shaped);
  const std::string text = Printed(table);
  EXPECT_THAT(text, HasSubstr("shapes"));
  EXPECT_THAT(text, HasSubstr("tetrahedra"));
  EXPECT_THAT(text, Not(HasSubstr("unspecified")));
}

TEST(ResourceTable, TimesThatAreNotKnownAreEmpty) {
  EXPECT_EQ(CreateTimeText(v1::Front(), absl::UTCTimeZone()), "");
}

}  // namespace
}  // namespace mortise::cli
