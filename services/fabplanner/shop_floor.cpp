#include "services/fabplanner/shop_floor.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "google/protobuf/util/time_util.h"
#include "services/fabplanner/order_records.h"
#include "services/fabplanner/plan_codec.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kLongestMachineName = 63;
constexpr std::size_t kLongestMachineState = 63;
constexpr std::size_t kLongestReason = 1000;
constexpr int kMostMachines = 100;  // at one bridge

// 1 to 63 letters, digits, '-', '_' and '.'.
bool IsMachineName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestMachineName &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '-' || c == '_' || c == '.';
         });
}

absl::Status CheckMachines(const google::protobuf::RepeatedPtrField<v1::Machine>& machines,
                           const std::string& path) {
  if (machines.size() > kMostMachines) {
    return InvalidField(path, absl::StrCat("has more than ", kMostMachines, " entries"));
  }
  std::set<std::string> names;
  for (int i = 0; i < machines.size(); ++i) {
    const v1::Machine& machine = machines[i];
    const std::string field = absl::StrCat(path, "[", i, "]");
    if (!IsMachineName(machine.name())) {
      return InvalidField(absl::StrCat(field, ".name"),
                          "must be 1 to 63 letters, digits, '-', '_' and '.'");
    }
    if (machine.state().size() > kLongestMachineState) {
      return InvalidField(absl::StrCat(field, ".state"), "is longer than 63 bytes");
    }
    if (machine.held_because().size() > kLongestReason) {
      return InvalidField(absl::StrCat(field, ".held_because"), "is longer than 1000 bytes");
    }
    if (!names.insert(machine.name()).second) {
      return InvalidField(absl::StrCat(field, ".name"),
                          absl::StrCat(machine.name(), " is used twice"));
    }
    if (machine.kind() == v1::MACHINE_KIND_UNSPECIFIED) {
      return InvalidField(absl::StrCat(field, ".kind"), "is needed");
    }
  }
  return absl::OkStatus();
}

// The bridges that have cuts of the order in hand.
std::set<std::string> UsersOf(const WorkOrder& work) {
  std::set<std::string> users;
  for (const Cut& cut : work.cuts()) {
    if (cut.state == CutState::kSent || cut.state == CutState::kAccepted) users.insert(cut.bridge);
  }
  return users;
}

// "saw of plant-2 is HELD: the line was down", one after the other.
std::string HeldText(const std::vector<v1::HeldMachine>& held) {
  std::vector<std::string> texts;
  for (const v1::HeldMachine& one : held) {
    const v1::Machine& machine = one.machine();
    texts.push_back(absl::StrCat(machine.name(), " of ", one.bridge(), " is ", machine.state(),
                                 machine.held_because().empty() ? "" : ": ",
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
      MORTISE_ASSIGN_OR_RETURN(const auto page, transaction.List(kOrderKind, options));
      for (const store::Record& record : page) {
        v1::WorkOrder order;
        if (!order.ParseFromString(record.payload)) {
          return StorageFailed(record.key, "the work order is not readable");
        }
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
  return &orders_.emplace(order_name, Order{std::move(summary), WorkOrder(std::move(cuts), state)})
              .first->second;
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
  changed_.notify_all();
  return absl::OkStatus();
}

absl::StatusOr<int64_t> ShopFloor::Attach(const v1::BridgeMessage::Hello& hello, Writer writer) {
  if (!IsResourceId(hello.bridge())) {
    return InvalidField("hello.bridge",
                        "must be a name of 1 to 63 lower-case letters, digits and hyphens");
  }
  MORTISE_RETURN_IF_ERROR(CheckMachines(hello.machines(), "hello.machines"));
  std::lock_guard lock(mutex_);
  const auto known = bridges_.find(hello.bridge());
  ReportLedger ledger;
  if (known == bridges_.end()) {
    MORTISE_ASSIGN_OR_RETURN(ledger, ReportLedger::ForNewBridge(hello.next_report_number()));
  } else {
    ledger = known->second.ledger;
    MORTISE_RETURN_IF_ERROR(ledger.CheckHello(hello.next_report_number()));
  }
  v1::ListBridgesResponse::Bridge stored;
  stored.set_name(hello.bridge());
  *stored.mutable_machines() = hello.machines();
  stored.set_reports_stored(ledger.stored());
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(PutBridge(transaction, stored));
    return transaction.AppendEvent(
        {.type = "bridge.attached",
         .subject = absl::StrCat("bridges/", hello.bridge()),
         .payload = absl::StrCat("{\"machines\":", hello.machines_size(), "}"),
         .trace_id = CurrentTraceId()});
  }));

  Bridge& bridge = bridges_[hello.bridge()];
  if (bridge.writer != nullptr) {
    bridge.writer->Finish(WithDetail(
        absl::AbortedError("a newer stream of this bridge has taken over"), {"REPLACED", ""}));
  }
  bridge.stored = std::move(stored);
  bridge.ledger = ledger;
  bridge.attachment = ++last_attachment_;
  bridge.writer = std::move(writer);
  const int64_t attachment = bridge.attachment;
  Log(LogLevel::kInfo, "bridge attached",
      {{"bridge", hello.bridge()}, {"reports_stored", ledger.stored()}});
  Acknowledge(bridge);
  for (auto& [name, order] : orders_) {
    SendPauses(order, hello.bridge());
    if (order.to_resume.contains(hello.bridge())) SendResume(order, hello.bridge());
    SendCuts(order, order.work.CutsToSendAgain(hello.bridge()));
  }
  if (const absl::Status status = GiveOutAll(); !status.ok()) {
    bridge.attachment = 0;
    bridge.writer = nullptr;
    return status;
  }
  return attachment;
}

void ShopFloor::Detach(int64_t attachment) {
  std::lock_guard lock(mutex_);
  for (auto& [name, bridge] : bridges_) {
    if (bridge.attachment != attachment) continue;
    bridge.attachment = 0;
    bridge.writer = nullptr;
    Log(LogLevel::kInfo, "bridge detached", {{"bridge", name}});
    const std::string subject = absl::StrCat("bridges/", name);
    const absl::Status told = store_->Transact([&](store::Transaction& transaction) {
      return transaction.AppendEvent({.type = "bridge.detached",
                                      .subject = subject,
                                      .payload = "{}",
                                      .trace_id = CurrentTraceId()});
    });
    if (!told.ok()) Log(LogLevel::kWarning, "event not stored", {{"error", told.message()}});
  }
}

absl::Status ShopFloor::Receive(int64_t attachment, const v1::BridgeMessage& message) {
  std::lock_guard lock(mutex_);
  Bridge* bridge = nullptr;
  for (auto& [name, candidate] : bridges_) {
    if (candidate.attachment == attachment) bridge = &candidate;
  }
  if (bridge == nullptr) return absl::OkStatus();
  for (auto& [name, order] : orders_) order.to_resume.erase(bridge->stored.name());
  switch (message.message_case()) {
    case v1::BridgeMessage::kHello:
      return InvalidField("hello", "has been said already");
    case v1::BridgeMessage::kMachineStates:
      MORTISE_RETURN_IF_ERROR(
          CheckMachines(message.machine_states().machines(), "machine_states.machines"));
      *bridge->stored.mutable_machines() = message.machine_states().machines();
      changed_.notify_all();
      return absl::OkStatus();
    case v1::BridgeMessage::kCommandAccepted:
      return Accepted(*bridge, message.command_accepted());
    case v1::BridgeMessage::kCutReport:
      return Reported(*bridge, message.cut_report());
    case v1::BridgeMessage::MESSAGE_NOT_SET:
      return InvalidField("message", "is empty");
  }
  return absl::OkStatus();
}

absl::Status ShopFloor::Accepted(Bridge& bridge,
                                 const v1::BridgeMessage::CommandAccepted& message) {
  const absl::StatusOr<Order*> order = FindOrder(message.work_order());
  if (absl::IsNotFound(order.status())) return absl::OkStatus();  // of a store that is gone
  MORTISE_RETURN_IF_ERROR(order.status());
  return Commit(*order, [&](WorkOrder& work) {
    const auto cut = work.Accept(bridge.stored.name(), message.machine(), message.sequence());
    return cut.has_value() ? std::vector<int>{*cut} : std::vector<int>{};
  });
}

absl::Status ShopFloor::Reported(Bridge& bridge, const v1::CutReport& message) {
  MORTISE_ASSIGN_OR_RETURN(const CutReport report, CutReportFrom(message));
  if (bridge.ledger.Judge(message.report_number()) != ReportLedger::Verdict::kNew) {
    Acknowledge(bridge);
    return absl::OkStatus();
  }
  ReportLedger ledger = bridge.ledger;
  ledger.Advance();
  v1::ListBridgesResponse::Bridge stored = bridge.stored;
  stored.set_reports_stored(ledger.stored());
  const Also keep_number = [&](store::Transaction& transaction) {
    return PutBridge(transaction, stored);
  };

  const absl::StatusOr<Order*> order = FindOrder(message.work_order());
  if (absl::IsNotFound(order.status())) {
    Log(LogLevel::kWarning, "a report of an unknown work order",
        {{"bridge", stored.name()}, {"work_order", message.work_order()}});
    MORTISE_RETURN_IF_ERROR(store_->Transact(keep_number));
  } else {
    MORTISE_RETURN_IF_ERROR(order.status());
    const OrderState before = (*order)->work.state();
    std::vector<int> given_out;
    MORTISE_RETURN_IF_ERROR(Commit(
        *order,
        [&](WorkOrder& work) {
          std::vector<int> touched;
          if (const auto cut = work.Report(stored.name(), report)) touched.push_back(*cut);
          given_out = work.GiveOut(AttachedMachines());
          touched.insert(touched.end(), given_out.begin(), given_out.end());
          return touched;
        },
        keep_number));
    SendCuts(**order, given_out);
    if ((*order)->work.state() != before) SendPauses(**order);
  }
  bridge.ledger = ledger;
  bridge.stored.set_reports_stored(ledger.stored());
  Acknowledge(bridge);
  return absl::OkStatus();
}

void ShopFloor::Acknowledge(Bridge& bridge) {
  v1::PlannerMessage message;
  message.mutable_reports_acknowledged()->set_report_number(bridge.ledger.stored());
  bridge.writer->Write(std::move(message));
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
  for (const std::string& user : UsersOf(order->work)) SendResume(*order, user);
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

std::vector<MachineAddress> ShopFloor::AttachedMachines() const {
  std::vector<MachineAddress> machines;
  for (const auto& [name, bridge] : bridges_) {
    if (bridge.attachment == 0) continue;
    for (const v1::Machine& machine : bridge.stored.machines()) {
      machines.push_back(
          {name, machine.name(),
           machine.kind() == v1::JIGSAW_ROBOT ? MachineKind::kJigsaw : MachineKind::kChopSaw});
    }
  }
  return machines;
}

void ShopFloor::SendCuts(const Order& order, const std::vector<int>& cuts) {
  for (int index : cuts) {
    const Cut& cut = order.work.cuts()[index];
    const Bridge& bridge = bridges_.at(cut.bridge);
    if (bridge.attachment == 0) continue;
    v1::PlannerMessage message;
    *message.mutable_cut() = ToProto(cut, order.summary.name()).command();
    bridge.writer->Write(std::move(message));
  }
}

// An order that is held, or ended with cuts still in bridges' journals, must not go on there.
void ShopFloor::SendPauses(Order& order, const std::string& only_bridge) {
  const OrderState state = order.work.state();
  if (state != OrderState::kHeld && state != OrderState::kFailed &&
      state != OrderState::kCancelled) {
    return;
  }
  order.to_resume.clear();
  v1::PlannerMessage hold;
  hold.mutable_hold()->set_work_order(order.summary.name());
  for (const std::string& user : UsersOf(order.work)) {
    const Bridge& bridge = bridges_.at(user);
    if (bridge.attachment == 0 || (!only_bridge.empty() && user != only_bridge)) continue;
    bridge.writer->Write(hold);
  }
}

void ShopFloor::SendResume(Order& order, const std::string& bridge_name) {
  const Bridge& bridge = bridges_.at(bridge_name);
  order.to_resume.insert(bridge_name);  // until something is heard from it (Receive)
  if (bridge.attachment == 0) return;
  v1::PlannerMessage resume;
  resume.mutable_resume()->set_work_order(order.summary.name());
  bridge.writer->Write(std::move(resume));
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

int ShopFloor::OrdersUnderWay() const {
  std::lock_guard lock(mutex_);
  int count = 0;
  for (const auto& [name, order] : orders_) count += IsFinal(order.work.state()) ? 0 : 1;
  return count;
}

std::vector<v1::ListBridgesResponse::Bridge> ShopFloor::Bridges() const {
  std::lock_guard lock(mutex_);
  std::vector<v1::ListBridgesResponse::Bridge> list;
  for (const auto& [name, bridge] : bridges_) {
    list.push_back(bridge.stored);
    list.back().set_attached(bridge.attachment != 0);
  }
  return list;
}

}  // namespace mortise::fabplanner
