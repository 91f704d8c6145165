#include "hwbridge/client/bridge_codec.h"

#include "common/base/errors.h"

namespace mortise::hwbridge {

absl::StatusOr<CutOrder> CutFromProto(const v1::CutCommand& command) {
  if (command.work_order().empty()) return InvalidField("cut.work_order", "is missing");
  if (command.machine().empty()) return InvalidField("cut.machine", "is missing");
  if (command.sequence() < 1) return InvalidField("cut.sequence", "must be at least 1");
  CutOrder order;
  order.key = {command.work_order(), command.machine(), command.sequence()};
  order.job.part = command.part();
  switch (command.cut_case()) {
    case v1::CutCommand::kCrosscut:
      order.job.kind = MachineKind::kChopSaw;
      order.job.stock = command.crosscut().stock();
      order.job.position = command.crosscut().position();
      order.job.length = command.crosscut().length();
      return order;
    case v1::CutCommand::kOutline:
      order.job.kind = MachineKind::kJigsaw;
      order.job.stock = command.outline().stock();
      for (const v1::Vector2& point : command.outline().outline()) {
        order.job.outline.push_back({point.u(), point.v()});
      }
      return order;
    case v1::CutCommand::CUT_NOT_SET:
      break;
  }
  return InvalidField("cut.cut", "is missing");
}

v1::CutReport ReportToProto(const CutReport& report) {
  v1::CutReport message;
  message.set_work_order(report.key.work_order);
  message.set_sequence(report.key.sequence);
  message.set_machine(report.key.machine);
  message.set_outcome(static_cast<v1::CutOutcome>(report.outcome));
  message.set_message(report.message);
  message.set_seconds(report.seconds);
  message.set_report_number(report.number);
  return message;
}

v1::Machine MachineToProto(const MachineView& view) {
  v1::Machine machine;
  machine.set_name(view.name);
  machine.set_kind(view.kind == MachineKind::kChopSaw ? v1::CHOP_SAW_WITH_FEEDER
                                                      : v1::JIGSAW_ROBOT);
  const bool could_go_on = view.state == "EXECUTE" || view.state == "IDLE" ||
                           view.state == "STOPPED" || view.state == "COMPLETE";
  machine.set_state(view.held && could_go_on ? "HELD" : view.state);
  if (view.held) machine.set_held_because(view.held_because);
  machine.set_alarm(view.alarm);
  return machine;
}

}  // namespace mortise::hwbridge
