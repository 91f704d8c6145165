// The shop floor's bridges: what comes from them and what they are told.
#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/names/offered_names.h"
#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/plan_codec.h"
#include "services/fabplanner/shop_floor/shop_floor.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kMaxMachineNameLength = 63;
constexpr std::size_t kMaxMachineStateLength = 63;
constexpr std::size_t kMaxReasonLength = 1000;
constexpr int kMaxMachines = 100;  // at one bridge

// 1 to 63 letters, digits, '-', '_' and '.'.
bool IsMachineName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxMachineNameLength &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '-' || c == '_' || c == '.';
         });
}

absl::Status CheckMachines(const google::protobuf::RepeatedPtrField<v1::Machine>& machines,
                           const std::string& path) {
  if (machines.size() > kMaxMachines) {
    return InvalidField(path, absl::StrCat("has more than ", kMaxMachines, " entries"));
  }
  std::set<std::string> names;
  for (int i = 0; i < machines.size(); ++i) {
    const v1::Machine& machine = machines[i];
    const std::string field = absl::StrCat(path, "[", i, "]");
    if (!IsMachineName(machine.name())) {
      return InvalidField(absl::StrCat(field, ".name"),
                          "must be 1 to 63 letters, digits, '-', '_' and '.'");
    }
    if (machine.state().size() > kMaxMachineStateLength) {
      return InvalidField(absl::StrCat(field, ".state"), "is longer than 63 bytes");
    }
    if (machine.held_because().size() > kMaxReasonLength) {
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

// Whether a machine has the alarm now that was told without it, or with another reason, before.
bool HasNewAlarm(const google::protobuf::RepeatedPtrField<v1::Machine>& before,
                 const google::protobuf::RepeatedPtrField<v1::Machine>& now) {
  return std::any_of(now.begin(), now.end(), [&](const v1::Machine& machine) {
    return machine.alarm() &&
           std::none_of(before.begin(), before.end(), [&](const v1::Machine& known) {
             return known.name() == machine.name() && known.alarm() &&
                    known.held_because() == machine.held_because();
           });
  });
}

}  // namespace

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
  // Whoever resumed an order while the bridge was away could not have looked at an alarm that rose
  // meanwhile.
  if (HasNewAlarm(bridge.stored.machines(), hello.machines())) {
    for (auto& [name, order] : orders_) order.to_resume.erase(hello.bridge());
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
  for (const std::string& user : order.work.Bridges()) {
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

absl::StatusOr<v1::HeldMachine> ShopFloor::FindAlarm(const std::string& bridge_name,
                                                     const std::string& machine_name) const {
  if (!IsMachineName(machine_name)) {
    return InvalidField("machine", "must be 1 to 63 letters, digits, '-', '_' and '.'");
  }
  if (!bridge_name.empty() && !IsResourceId(bridge_name)) {
    return InvalidField("bridge",
                        "must be a name of 1 to 63 lower-case letters, digits and hyphens");
  }
  std::lock_guard lock(mutex_);
  std::optional<v1::HeldMachine> found;
  bool is_attached = false;
  std::vector<std::string> machine_names;
  for (const auto& [name, bridge] : bridges_) {
    if (!bridge_name.empty() && name != bridge_name) continue;
    for (const v1::Machine& machine : bridge.stored.machines()) {
      machine_names.push_back(machine.name());
      if (machine.name() != machine_name) continue;
      if (found) {
        return InvalidField("bridge", absl::StrCat("is needed: ", found->bridge(), " and ", name,
                                                   " both have a machine ", machine_name));
      }
      found.emplace().set_bridge(name);
      *found->mutable_machine() = machine;
      is_attached = bridge.attachment != 0;
    }
  }
  if (!found) {
    const absl::Status missing = ResourceNotFound(
        bridge_name.empty() ? absl::StrCat("machine ", machine_name)
                            : absl::StrCat("machine ", machine_name, " of ", bridge_name));
    return WithDetail(
        absl::Status(missing.code(),
                     absl::StrCat(missing.message(), NamesOffered(machine_name, machine_names))),
        DetailOf(missing));
  }
  const std::string whole_name = absl::StrCat(machine_name, " of ", found->bridge());
  if (!is_attached) {
    return PreconditionFailed(
        "BRIDGE_AWAY", absl::StrCat(whole_name, " cannot be told: its bridge is not attached"),
        "machine");
  }
  if (!found->machine().alarm()) {
    return PreconditionFailed("NO_ALARM", absl::StrCat(whole_name, " has not raised the alarm"),
                              "machine");
  }
  return *std::move(found);
}

void ShopFloor::ClearAlarm(const std::string& bridge_name, const std::string& machine_name) {
  std::lock_guard lock(mutex_);
  const auto bridge = bridges_.find(bridge_name);
  if (bridge == bridges_.end() || bridge->second.attachment == 0) return;
  v1::PlannerMessage message;
  message.mutable_clear_alarm()->set_machine(machine_name);
  bridge->second.writer->Write(std::move(message));
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
