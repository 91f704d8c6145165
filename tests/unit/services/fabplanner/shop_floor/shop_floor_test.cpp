// The shop floor and its store: what others write of an order while its cuts are made.
#include "services/fabplanner/shop_floor/shop_floor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/work_order_calls.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::fabplanner {
namespace {

constexpr int kCuts = 12;
constexpr char kOrder[] = "workOrders/o1";

// Takes what a bridge would be sent.
class BridgeLine : public rpc::StreamWriter<v1::PlannerMessage> {
 public:
  bool Write(v1::PlannerMessage message) override {
    if (message.has_cut()) commands_.push_back(message.cut());
    return true;
  }
  bool WriteLatest(v1::PlannerMessage message) override { return Write(std::move(message)); }
  void Pull(std::function<absl::StatusOr<std::optional<v1::PlannerMessage>>()>) override {}
  void Wake() override {}
  void Finish(absl::Status) override {}
  bool cancelled() const override { return false; }
  void OnEnd(std::function<void()>) override {}

  const std::vector<v1::CutCommand>& commands() const { return commands_; }

 private:
  std::vector<v1::CutCommand> commands_;
};

class ShopFloorTest : public ::testing::Test {
 protected:
  // An order of one board, all of whose cuts a saw has been given.
  void SetUp() override {
    ASSERT_OK(store_->Transact([](store::Transaction& transaction) -> absl::Status {
      v1::WorkOrder order;
      order.set_name(kOrder);
      order.set_plan("plans/p1");
      order.set_state(v1::WorkOrder::RELEASED);
      order.set_cuts_total(kCuts);
      order.set_creator("users/ada");
      for (int i = 0; i < kCuts; ++i) {
        Cut cut;
        cut.stock = "board-1";
        cut.part = "part-" + std::to_string(i);
        MORTISE_RETURN_IF_ERROR(PutCut(transaction, kOrder, i, cut));
      }
      return PutOrder(transaction, order);
    }));
    ASSERT_OK(floor_.Open());
    v1::BridgeMessage::Hello hello;
    hello.set_bridge("north");
    hello.set_next_report_number(1);
    v1::Machine& saw = *hello.add_machines();
    saw.set_name("saw-1");
    saw.set_kind(v1::CHOP_SAW_WITH_FEEDER);
    saw.set_state("EXECUTE");
    const auto attached = floor_.Attach(hello, line_);
    ASSERT_OK(attached);
    attachment_ = *attached;
    ASSERT_EQ(line_->commands().size(), static_cast<std::size_t>(kCuts));
  }

  // The bridge reports that the n-th cut is done.
  absl::Status Report(int n) {
    const v1::CutCommand& command = line_->commands()[static_cast<std::size_t>(n)];
    v1::BridgeMessage message;
    v1::CutReport& report = *message.mutable_cut_report();
    report.set_work_order(kOrder);
    report.set_machine(command.machine());
    report.set_sequence(command.sequence());
    report.set_outcome(v1::CUT_DONE);
    report.set_report_number(n + 1);
    return floor_.Receive(attachment_, message);
  }

  // Labels the order with a number, as UpdateWorkOrder does.
  absl::Status Label(int number) {
    v1::WorkOrder changes;
    changes.set_name(kOrder);
    (*changes.mutable_labels())["number"] = std::to_string(number);
    return store_->Transact([&](store::Transaction& transaction) {
      return kOrders
          .UpdateTags(transaction, changes, {}, "work_order",
                      {.user = "users/ben", .trace_id = "t-1"})
          .status();
    });
  }

  v1::WorkOrder Order() {
    const auto order = kOrders.Get(*store_, kOrder);
    EXPECT_OK(order);
    return order.ok() ? *order : v1::WorkOrder();
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
  ShopFloor floor_{store_.get()};
  const std::shared_ptr<BridgeLine> line_ = std::make_shared<BridgeLine>();
  int64_t attachment_ = 0;
};

TEST_F(ShopFloorTest, ReportsKeepTheTagsOfAnOrderAndTagsItsState) {
  for (int i = 0; i < kCuts; ++i) {
    ASSERT_OK(Label(i));
    EXPECT_EQ(Order().cuts_done(), i);
    ASSERT_OK(Report(i));
    EXPECT_EQ(Order().labels().at("number"), std::to_string(i));
  }
  EXPECT_EQ(Order().state(), v1::WorkOrder::COMPLETED);
  EXPECT_EQ(Order().creator(), "users/ada");
  ASSERT_OK(Label(kCuts));
  EXPECT_EQ(Order().state(), v1::WorkOrder::COMPLETED);
  EXPECT_EQ(Order().cuts_done(), kCuts);
  EXPECT_EQ(Order().labels().at("number"), std::to_string(kCuts));
}

TEST_F(ShopFloorTest, TagsChangeWhileCutsAreReported) {
  std::atomic<bool> cutting = true;
  std::thread bridge([&] {
    for (int i = 0; i < kCuts; ++i) EXPECT_OK(Report(i));
    cutting = false;
  });
  int labelled = 0;
  do {
    EXPECT_OK(Label(++labelled));
  } while (cutting);
  bridge.join();
  EXPECT_EQ(Order().state(), v1::WorkOrder::COMPLETED);
  EXPECT_EQ(Order().cuts_done(), kCuts);
  EXPECT_EQ(Order().labels().at("number"), std::to_string(labelled));
}

TEST_F(ShopFloorTest, AHeldOrderStaysHeldWhenItsTagsChange) {
  ASSERT_OK(store_->Transact(
      [](store::Transaction& transaction) { return HoldOrder(kOrder, transaction).status(); }));
  ASSERT_OK(Label(1));
  ASSERT_OK(floor_.Refresh(kOrder));
  ASSERT_OK(Report(0));
  EXPECT_EQ(Order().state(), v1::WorkOrder::HELD);
  EXPECT_EQ(Order().cuts_done(), 1);
  EXPECT_EQ(Order().labels().at("number"), "1");
}

}  // namespace
}  // namespace mortise::fabplanner
