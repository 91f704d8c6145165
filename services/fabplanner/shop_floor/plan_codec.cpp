#include "services/fabplanner/shop_floor/plan_codec.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/messages/vector_codec.h"
#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/plan/bill_of_materials.h"

namespace mortise::fabplanner {
namespace {

void SetMoney(const Money& money, v1::Money* message) {
  message->set_currency(money.currency);
  message->set_amount(money.amount);
}

template <class Points>
void AddPoints(const std::vector<Eigen::Vector2d>& outline, Points* points) {
  for (const Eigen::Vector2d& point : outline) {
    v1::Vector2* message = points->Add();
    message->set_u(point.x());
    message->set_v(point.y());
  }
}

template <class Points>
std::vector<Eigen::Vector2d> PointsFrom(const Points& points) {
  std::vector<Eigen::Vector2d> outline;
  for (const v1::Vector2& point : points) outline.emplace_back(point.u(), point.v());
  return outline;
}

void SetRules(const WorkshopRules& rules, v1::WorkshopRules* message) {
  message->set_kerf(rules.kerf);
  message->set_board_trim(rules.board_trim);
  message->set_sheet_trim(rules.sheet_trim);
  message->set_sheet_spacing(rules.sheet_spacing);
  message->set_mitre_limit(rules.mitre_limit);
  message->set_bevel_limit(rules.bevel_limit);
  message->set_compound_cuts(rules.compound_cuts);
  message->set_jigsaw_radius(rules.jigsaw_radius);
}

// Writes the ends that are not square.
template <class Message>
void SetEnds(const CutEnds& ends, Message* message) {
  const auto set = [](const EndSlope& end, v1::EndCut* cut) {
    cut->set_mitre(MitreOf(end));
    cut->set_bevel(BevelOf(end));
  };
  if (!IsSquare(ends.front)) set(ends.front, message->mutable_front_cut());
  if (!IsSquare(ends.rear)) set(ends.rear, message->mutable_rear_cut());
}

template <class Message>
CutEnds EndsFrom(const Message& message) {
  return {SlopeOf(message.front_cut().mitre(), message.front_cut().bevel()),
          SlopeOf(message.rear_cut().mitre(), message.rear_cut().bevel())};
}

void AddBoard(const BoardLayout& board, v1::Plan* plan) {
  v1::BoardLayout* message = plan->add_boards();
  message->set_label(board.label);
  message->set_item(board.item);
  message->set_width(board.width);
  message->set_thickness(board.thickness);
  message->set_stock_length(board.stock_length);
  message->set_offcut(board.offcut);
  message->set_plank(board.plank);
  message->set_plank_position(board.plank_position);
  for (const BoardSegment& segment : board.segments) {
    v1::BoardLayout::Segment* part = message->add_segments();
    part->set_part(segment.part);
    part->set_start(segment.start);
    part->set_length(segment.length);
    SetEnds(segment.ends, part);
  }
}

void AddSheet(const SheetLayout& sheet, v1::Plan* plan) {
  v1::SheetLayout* message = plan->add_sheets();
  message->set_label(sheet.label);
  message->set_item(sheet.item);
  message->set_length(sheet.length);
  message->set_width(sheet.width);
  message->set_thickness(sheet.thickness);
  for (const SheetPlacement& placement : sheet.placements) {
    v1::SheetLayout::Placement* part = message->add_placements();
    part->set_part(placement.part);
    AddPoints(placement.outline, part->mutable_outline());
  }
}

void AddStep(const AssemblyStep& step, v1::Plan* plan) {
  v1::AssemblyStep* message = plan->add_steps();
  message->set_number(step.number);
  message->set_priority(step.priority);
  for (const std::string& part : step.added_parts) message->add_added_parts(part);
  std::set<std::string> connections;  // of several copies each is told once
  for (const StepConnection& connection : step.connections) {
    if (connections.insert(connection.name).second) message->add_connections(connection.name);
  }
  message->set_pegs(step.pegs);
  message->set_instruction(step.instruction);
  message->set_picture(StepPictureName(step.number));
  for (const std::string& connector : step.connectors) message->add_connectors(connector);
  message->set_subassembly(step.subassembly);
  Eigen::Vector3d way_in = Eigen::Vector3d::Zero();
  for (const AssemblyStep::Move& move : step.moves) {
    if (move.way_in.isZero()) continue;
    if (!way_in.isZero() && !way_in.isApprox(move.way_in)) return;
    way_in = move.way_in;
  }
  if (!way_in.isZero()) *message->mutable_way_in() = VectorToProto(way_in);
}

void AddPart(const PlannedPart& planned, const Part& part, v1::Plan* plan) {
  v1::PlannedPart* message = plan->add_parts();
  message->set_name(planned.part);
  message->set_title(part.title);
  message->set_item(part.item);
  // The two enums name the same ways in the same order, after an unspecified one.
  message->set_making(static_cast<v1::PlannedPart::Making>(static_cast<int>(planned.making) + 1));
  *message->mutable_size() = VectorToProto(planned.size);
  message->set_material(part.material);
  message->set_mass(part.mass);
  message->set_connecting(part.connecting);
  message->set_handwork(planned.handwork);
  for (const std::string& drawing : planned.drawings) message->add_drawings(drawing);
  SetEnds(planned.ends, message);
  for (const MachineLimit& limit : planned.beyond_machines) {
    v1::MachineLimit* told = message->add_beyond_machines();
    // The two enums name the same rules in the same order, after an unspecified one.
    told->set_kind(static_cast<v1::MachineLimit::Kind>(static_cast<int>(limit.kind) + 1));
    told->set_place(limit.place);
    told->set_value(limit.value);
    told->set_limit(limit.limit);
    told->set_message(absl::StrCat("its ", limit.place, " ", limit.reason));
    for (const auto& [name, value] : limit.nearest_parameters) {
      v1::ParameterValue* nearest = told->add_nearest_parameters();
      nearest->set_name(name);
      nearest->set_value(value);
    }
  }
}

void AddHole(const Hole& hole, v1::Plan* plan) {
  v1::Hole* message = plan->add_holes();
  message->set_part(hole.part);
  *message->mutable_position() = VectorToProto(hole.position);
  *message->mutable_direction() = VectorToProto(hole.direction);
  message->set_diameter(hole.diameter);
  message->set_depth(hole.depth);
  message->set_kind(static_cast<v1::Hole::Kind>(static_cast<int>(hole.kind) + 1));
  message->set_through(hole.through);
  message->set_connector(hole.connector);
}

void AddBillLine(const BillLine& line, v1::Plan* plan) {
  v1::BillLine* message = plan->add_bill();
  message->set_item(line.item);
  message->set_title(line.title);
  message->set_quantity(line.quantity);
  message->set_dimensions(line.dimensions);
  message->set_supplier(line.supplier);
  message->set_supplier_number(line.supplier_number);
  message->set_supplier_url(line.supplier_url);
  for (const std::string& part : line.parts) message->add_parts(part);
  message->set_material(line.material);
  message->set_mass(line.mass);
  for (const std::string& drawing : line.drawings) message->add_drawings(drawing);
  if (line.price.currency.empty()) return;
  SetMoney(line.unit_price, message->mutable_unit_price());
  SetMoney(line.price, message->mutable_price());
}

void AddBillNode(const BillTree& tree, const BillNode& node, v1::BillTree* message) {
  v1::BillNode* told = message->add_nodes();
  told->set_id(node.id);
  if (node.parent >= 0) told->set_parent(tree.nodes[static_cast<std::size_t>(node.parent)].id);
  // The two enums name the same kinds in the same order, after an unspecified one.
  told->set_kind(static_cast<v1::BillNode::Kind>(static_cast<int>(node.kind) + 1));
  told->set_name(node.name);
  told->set_title(node.title);
  told->set_quantity(node.quantity);
  told->set_total_quantity(node.total_quantity);
  told->mutable_parts()->Assign(node.parts.begin(), node.parts.end());
  told->set_item(node.item);
  told->set_item_revision(node.item_revision);
  told->mutable_external_ids()->Assign(node.external_ids.begin(), node.external_ids.end());
  told->set_material(node.material);
  if (node.mass) told->set_mass(*node.mass);
  *told->mutable_size() = VectorToProto(node.size);
  told->set_dimensions(node.dimensions);
  told->set_supplier(node.supplier);
  told->set_supplier_number(node.supplier_number);
  told->set_supplier_url(node.supplier_url);
  if (!node.unit_price.currency.empty()) SetMoney(node.unit_price, told->mutable_unit_price());
  if (!node.price.currency.empty()) SetMoney(node.price, told->mutable_price());
  told->mutable_artifacts()->Assign(node.artifacts.begin(), node.artifacts.end());
}

void SetBillTree(const BillTree& tree, v1::BillTree* message) {
  message->set_template_(tree.template_name);
  message->set_template_revision(tree.template_revision);
  message->set_assembly(tree.assembly);
  message->set_assembly_revision(tree.assembly_revision);
  message->mutable_effective_from()->set_seconds(tree.effective_from);
  for (const BillNode& node : tree.nodes) AddBillNode(tree, node, message);
}

}  // namespace

WorkshopRules RulesFrom(const v1::WorkshopRules& message) {
  WorkshopRules rules;
  if (message.has_kerf()) rules.kerf = message.kerf();
  if (message.has_board_trim()) rules.board_trim = message.board_trim();
  if (message.has_sheet_trim()) rules.sheet_trim = message.sheet_trim();
  if (message.has_sheet_spacing()) rules.sheet_spacing = message.sheet_spacing();
  if (message.has_mitre_limit()) rules.mitre_limit = message.mitre_limit();
  if (message.has_bevel_limit()) rules.bevel_limit = message.bevel_limit();
  if (message.has_compound_cuts()) rules.compound_cuts = message.compound_cuts();
  if (message.has_jigsaw_radius()) rules.jigsaw_radius = message.jigsaw_radius();
  return rules;
}

v1::Plan ToProto(const FabricationPlan& plan, const Design& design) {
  v1::Plan message;
  message.set_quantity(plan.quantity);
  SetRules(plan.rules, message.mutable_rules());
  for (const BoardLayout& board : plan.boards) AddBoard(board, &message);
  for (const SheetLayout& sheet : plan.sheets) AddSheet(sheet, &message);
  for (const AssemblyStep& step : plan.steps) AddStep(step, &message);
  for (const BillLine& line : plan.bill.lines) AddBillLine(line, &message);
  if (!plan.bill_tree.nodes.empty()) SetBillTree(plan.bill_tree, message.mutable_bill_tree());
  for (const Money& total : plan.bill.totals) SetMoney(total, message.add_totals());
  if (message.totals_size() == 1) *message.mutable_total() = message.totals(0);
  message.set_unpriced_lines(UnpricedLines(plan.bill));
  for (const Hole& hole : plan.holes) AddHole(hole, &message);
  for (const Mark& mark : plan.marks) {
    v1::Mark* drawn = message.add_marks();
    drawn->set_part(mark.part);
    drawn->set_connector(mark.connector);
    *drawn->mutable_minimum() = VectorToProto(mark.region.min());
    *drawn->mutable_maximum() = VectorToProto(mark.region.max());
  }
  for (std::size_t i = 0; i < plan.parts.size(); ++i) {
    AddPart(plan.parts[i], design.parts[i], &message);
  }
  for (const std::string& handwork : plan.handwork) message.add_handwork(handwork);
  message.set_chop_saw_parts(plan.chop_saw_parts);
  message.set_jigsaw_parts(plan.jigsaw_parts);
  message.set_pegs(plan.pegs);
  return message;
}

FabricationPlan CuttingPlanFrom(const v1::Plan& message) {
  FabricationPlan plan;
  plan.quantity = message.quantity();
  plan.rules = RulesFrom(message.rules());
  for (const v1::BoardLayout& board : message.boards()) {
    BoardLayout& layout = plan.boards.emplace_back();
    layout.label = board.label();
    layout.item = board.item();
    layout.width = board.width();
    layout.thickness = board.thickness();
    layout.stock_length = board.stock_length();
    layout.offcut = board.offcut();
    layout.plank = board.plank();
    layout.plank_position = board.plank_position();
    for (const v1::BoardLayout::Segment& segment : board.segments()) {
      layout.segments.push_back(
          {segment.part(), segment.start(), segment.length(), EndsFrom(segment)});
    }
  }
  for (const v1::SheetLayout& sheet : message.sheets()) {
    SheetLayout& layout = plan.sheets.emplace_back();
    layout.label = sheet.label();
    layout.item = sheet.item();
    layout.length = sheet.length();
    layout.width = sheet.width();
    layout.thickness = sheet.thickness();
    for (const v1::SheetLayout::Placement& placement : sheet.placements()) {
      layout.placements.push_back({placement.part(), PointsFrom(placement.outline())});
    }
  }
  return plan;
}

v1::WorkOrder::Cut ToProto(const Cut& cut, const std::string& work_order) {
  v1::WorkOrder::Cut message;
  v1::CutCommand* command = message.mutable_command();
  command->set_work_order(work_order);
  command->set_sequence(cut.sequence);
  command->set_machine(cut.machine);
  command->set_part(cut.part);
  if (cut.kind == MachineKind::kChopSaw) {
    command->mutable_crosscut()->set_stock(cut.stock);
    command->mutable_crosscut()->set_position(cut.position);
    command->mutable_crosscut()->set_length(cut.length);
  } else {
    command->mutable_outline()->set_stock(cut.stock);
    AddPoints(cut.outline, command->mutable_outline()->mutable_outline());
  }
  // The two enums name the same states in the same order, after an unspecified one.
  message.set_state(static_cast<v1::WorkOrder::Cut::State>(static_cast<int>(cut.state) + 1));
  message.set_message(cut.message);
  message.set_seconds(cut.seconds);
  message.set_bridge(cut.bridge);
  return message;
}

Cut CutFrom(const v1::WorkOrder::Cut& message) {
  Cut cut;
  const v1::CutCommand& command = message.command();
  if (command.has_outline()) {
    cut.kind = MachineKind::kJigsaw;
    cut.stock = command.outline().stock();
    cut.outline = PointsFrom(command.outline().outline());
  } else {
    cut.stock = command.crosscut().stock();
    cut.position = command.crosscut().position();
    cut.length = command.crosscut().length();
  }
  cut.part = command.part();
  cut.state = static_cast<CutState>(std::max(0, static_cast<int>(message.state()) - 1));
  cut.bridge = message.bridge();
  cut.machine = command.machine();
  cut.sequence = command.sequence();
  cut.message = message.message();
  cut.seconds = message.seconds();
  return cut;
}

v1::WorkOrder::State ToProto(OrderState state) {
  return static_cast<v1::WorkOrder::State>(static_cast<int>(state) + 1);
}

OrderState OrderStateFrom(v1::WorkOrder::State state) {
  return static_cast<OrderState>(std::max(0, static_cast<int>(state) - 1));
}

absl::StatusOr<CutReport> CutReportFrom(const v1::CutReport& message) {
  CutReport report{message.machine(), message.sequence(), CutOutcome::kDone, message.message(),
                   message.seconds()};
  switch (message.outcome()) {
    case v1::CUT_DONE:
      return report;
    case v1::CUT_REJECTED:
      report.outcome = CutOutcome::kRejected;
      return report;
    case v1::CUT_FAILED:
      report.outcome = CutOutcome::kFailed;
      return report;
    default:
      return InvalidField("cut_report.outcome", "says nothing about how the cut ended");
  }
}

}  // namespace mortise::fabplanner
