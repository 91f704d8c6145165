// The shop floor's orders; its bridges are in shop_floor_bridges.cpp.
#include "services/fabplanner/shop_floor/shop_floor.h"

#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "google/protobuf/util/time_util.h"
#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/plan_codec.h"

namespace mortise::fabplanner {
namespace {

// "saw of plant-2 is HELD: the line was down", one after the other; "raised the alarm and is HELD".
std::string HeldText(const std::vector<v1::HeldMachine>& held) {
  std::vector<std::string> texts;
  for (const v1::HeldMachine& one : held) {
    const v1::Machine& machine = one.machine();
    texts.push_back(absl::StrCat(machine.name(), " of ", one.bridge(),
                                 machine.alarm() ? " raised the alarm and" : "", " is ",
                                 machine.state(), machine.held_because().empty() ? "" : ": ",
                                 machine.held_because()));
  }
  return absl::StrJoin(texts, "; ");
}

google::protobuf::Timestamp ToTimestamp(absl::Time time) {
  return google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(time));
}

}  // namespace

absl::Status ShopFloor::Open() {
  std::lock_guard lock(mutex_);
  std::vector<std::string> under_way;
  MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
    under_way.clear();
    MORTISE_ASSIGN_OR_RETURN(const auto bridges, GetBridges(transaction));
    for (const v1::ListBridgesResponse::Bridge& stored : bridges) {
      Bridge& bridge = bridges_[stored.name()];
      bridge.stored = stored;
      bridge.ledger = ReportLedger(stored.reports_stored());
    }
    store::ListOptions options;
    options.limit = 1000;
    while (true) {
      MORTISE_ASSIGN_OR_RETURN(const auto page, transaction.List(kOrders.kind, options));
      for (const store::Record& record : page) {
        MORTISE_ASSIGN_OR_RETURN(const auto order,
                                 resources::ParseRecord<v1::WorkOrder>(kOrders.kind, record));
        if (!IsFinal(OrderStateFrom(order.state()))) under_way.push_back(order.name());
      }
      if (page.size() < 1000) return absl::OkStatus();
      options.after_key = page.back().key;
    }
  }));
  for (const std::string& name : under_way) {
    MORTISE_RETURN_IF_ERROR(FindOrder(name).status());
  }
  return absl::OkStatus();
}

absl::StatusOr<ShopFloor::Order*> ShopFloor::FindOrder(const std::string& order_name) {
  const auto known = orders_.find(order_name);
  if (known != orders_.end()) return &known->second;
  v1::WorkOrder summary;
  std::vector<Cut> cuts;
  MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
    cuts.clear();
    MORTISE_ASSIGN_OR_RETURN(summary, GetOrder(transaction, order_name));
    MORTISE_ASSIGN_OR_RETURN(const auto stored, GetCuts(transaction, order_name));
    for (const v1::WorkOrder::Cut& cut : stored) cuts.push_back(CutFrom(cut));
    return absl::OkStatus();
  }));
  const OrderState state = OrderStateFrom(summary.state());
  const auto taken_up =
      orders_.emplace(order_name, Order{std::move(summary), WorkOrder(std::move(cuts), state)});
  CountOrdersUnderWay();
  return &taken_up.first->second;
}

absl::Status ShopFloor::Commit(Order* order, const Change& change, const Also& also) {
  v1::WorkOrder summary;
  std::optional<WorkOrder> work;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(summary, GetOrder(transaction, order->summary.name()));
    work = order->work;
    work->Adopt(OrderStateFrom(summary.state()));
    const std::vector<int> touched = change(*work);
    for (int index : touched) {
      const Cut& cut = work->cuts()[index];
      MORTISE_RETURN_IF_ERROR(PutCut(transaction, summary.name(), index, cut));
      MORTISE_RETURN_IF_ERROR(AppendCutEvent(transaction, summary.name(), cut));
    }
    const v1::WorkOrder::State state = ToProto(work->state());
    const bool new_state = state != summary.state();
    if (new_state || work->done() != summary.cuts_done()) {
      summary.set_state(state);
      summary.set_cuts_done(work->done());
      *summary.mutable_update_time() = ToTimestamp(transaction.Now());
      MORTISE_RETURN_IF_ERROR(PutOrder(transaction, summary));
      if (new_state) MORTISE_RETURN_IF_ERROR(AppendOrderEvent(transaction, summary));
    }
    return also == nullptr ? absl::OkStatus() : also(transaction);
  }));
  order->summary = std::move(summary);
  order->work = *std::move(work);
  CountOrdersUnderWay();
  changed_.notify_all();
  return absl::OkStatus();
}

absl::Status ShopFloor::Refresh(const std::string& order_name) {
  return TakeOver(order_name, false);
}

absl::Status ShopFloor::Resumed(const std::string& order_name) {
  return TakeOver(order_name, true);
}

absl::Status ShopFloor::TakeOver(const std::string& order_name, bool resumed) {
  std::lock_guard lock(mutex_);
  MORTISE_ASSIGN_OR_RETURN(Order * order, FindOrder(order_name));
  std::vector<int> given_out;
  const std::vector<MachineAddress> machines = AttachedMachines();
  MORTISE_RETURN_IF_ERROR(Commit(order, [&](WorkOrder& work) {
    given_out = work.GiveOut(machines);
    return given_out;
  }));
  if (order->work.state() != OrderState::kInProgress) {
    SendPauses(*order);
    return absl::OkStatus();
  }
  if (!resumed) {
    SendCuts(*order, given_out);
    return absl::OkStatus();
  }
  for (const std::string& user : order->work.Bridges()) SendResume(*order, user);
  for (const auto& [name, bridge] : bridges_) {
    if (bridge.attachment != 0) SendCuts(*order, order->work.CutsToSendAgain(name));
  }
  return absl::OkStatus();
}

absl::Status ShopFloor::Cancel(const std::string& order_name) {
  std::lock_guard lock(mutex_);
  MORTISE_ASSIGN_OR_RETURN(Order * order, FindOrder(order_name));
  MORTISE_RETURN_IF_ERROR(Commit(order, [&](WorkOrder& work) {
    work.Cancel(order_name).IgnoreError();
    return std::vector<int>();
  }));
  SendPauses(*order);
  return absl::OkStatus();
}

absl::Status ShopFloor::GiveOutAll() {
  const std::vector<MachineAddress> machines = AttachedMachines();
  for (auto& [name, order] : orders_) {
    if (IsFinal(order.work.state())) continue;
    WorkOrder trial = order.work;  // most attachments change nothing
    if (trial.GiveOut(machines).empty()) continue;
    std::vector<int> given_out;
    MORTISE_RETURN_IF_ERROR(Commit(&order, [&](WorkOrder& work) {
      given_out = work.GiveOut(machines);
      return given_out;
    }));
    SendCuts(order, given_out);
  }
  return absl::OkStatus();
}

absl::StatusOr<ShopFloor::Standing> ShopFloor::WaitForChange(const std::string& order_name,
                                                             const Standing& known,
                                                             absl::Duration timeout) {
  std::unique_lock lock(mutex_);
  const auto deadline = std::chrono::steady_clock::now() + absl::ToChronoMilliseconds(timeout);
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const Order* order, FindOrder(order_name));
    const WorkOrder& work = order->work;
    std::string held = HeldText(HeldMachinesOf(*order));
    if (work.state() != known.state || work.done() != known.done || known.total == 0 ||
        held != known.held || std::chrono::steady_clock::now() >= deadline) {
      return Standing{work.state(), work.done(), static_cast<int>(work.cuts().size()),
                      work.Trouble(), std::move(held)};
    }
    changed_.wait_until(lock, deadline);
  }
}

std::vector<v1::HeldMachine> ShopFloor::HeldMachinesOf(const Order& order) const {
  std::vector<v1::HeldMachine> held;
  if (IsFinal(order.work.state())) return held;
  std::set<std::pair<std::string, std::string>> in_use;
  for (const Cut& cut : order.work.cuts()) {
    if (cut.state == CutState::kSent || cut.state == CutState::kAccepted) {
      in_use.emplace(cut.bridge, cut.machine);
    }
  }
  for (const auto& [bridge_name, machine_name] : in_use) {
    for (const v1::Machine& machine : bridges_.at(bridge_name).stored.machines()) {
      if (machine.name() != machine_name) continue;
      if (machine.held_because().empty() && machine.state() != "HELD") continue;
      v1::HeldMachine& found = held.emplace_back();
      found.set_bridge(bridge_name);
      *found.mutable_machine() = machine;
    }
  }
  return held;
}

std::vector<v1::HeldMachine> ShopFloor::HeldMachines(const std::string& order_name) const {
  std::lock_guard lock(mutex_);
  const auto order = orders_.find(order_name);
  return order == orders_.end() ? std::vector<v1::HeldMachine>{} : HeldMachinesOf(order->second);
}

void ShopFloor::Forget(const std::string& order_name) {
  std::lock_guard lock(mutex_);
  const auto order = orders_.find(order_name);
  if (order != orders_.end() && IsFinal(order->second.work.state())) orders_.erase(order);
}

void ShopFloor::CountOrdersUnderWay() {
  int count = 0;
  for (const auto& [name, order] : orders_) count += IsFinal(order.work.state()) ? 0 : 1;
  orders_under_way_ = count;
}

}  // namespace mortise::fabplanner
