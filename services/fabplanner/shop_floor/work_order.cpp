#include "services/fabplanner/shop_floor/work_order.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

bool HasEnded(CutState state) {
  return state == CutState::kCut || state == CutState::kRejected || state == CutState::kFailed;
}

absl::Status AlreadyFinished(const std::string& name, OrderState state) {
  return PreconditionFailed("WORK_ORDER_FINISHED",
                            absl::StrCat(name, " is ", OrderStateName(state)), name);
}

}  // namespace

const char* OrderStateName(OrderState state) {
  switch (state) {
    case OrderState::kReleased:
      return "released";
    case OrderState::kInProgress:
      return "in progress";
    case OrderState::kHeld:
      return "held";
    case OrderState::kCompleted:
      return "completed";
    case OrderState::kFailed:
      return "failed";
    case OrderState::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

bool IsFinal(OrderState state) {
  return state == OrderState::kCompleted || state == OrderState::kFailed ||
         state == OrderState::kCancelled;
}

std::vector<Cut> CutsFor(const FabricationPlan& plan) {
  std::vector<Cut> cuts;
  for (const BoardLayout& board : plan.boards) {
    if (HasSlopedEnds(board)) continue;
    const double trim = plan.rules.board_trim - plan.rules.kerf;
    if (trim > 0) {
      Cut& cut = cuts.emplace_back();
      cut.stock = board.label;
      cut.part = absl::StrCat(board.label, ".trim");
      cut.position = cut.length = trim;
    }
    for (const BoardSegment& segment : board.segments) {
      Cut& cut = cuts.emplace_back();
      cut.stock = board.label;
      cut.part = segment.part;
      cut.position = segment.start + segment.length;
      cut.length = segment.length;
    }
  }
  for (const SheetLayout& sheet : plan.sheets) {
    for (const SheetPlacement& placement : sheet.placements) {
      Cut& cut = cuts.emplace_back();
      cut.kind = MachineKind::kJigsaw;
      cut.stock = sheet.label;
      cut.part = placement.part;
      cut.outline = placement.outline;
    }
  }
  return cuts;
}

WorkOrder::WorkOrder(std::vector<Cut> cuts, OrderState state)
    : state_(state), cuts_(std::move(cuts)) {
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    const Cut& cut = cuts_[i];
    done_ += cut.state == CutState::kCut ? 1 : 0;
    if (cut.state == CutState::kWaiting) continue;
    given_out_ = true;
    by_address_[{cut.bridge, cut.machine, cut.sequence}] = static_cast<int>(i);
    int64_t& last = last_sequence_[{cut.bridge, cut.machine}];
    last = std::max(last, cut.sequence);
  }
}

std::map<std::pair<std::string, std::string>, WorkOrder::Load> WorkOrder::Loads() const {
  std::map<std::pair<std::string, std::string>, Load> loads;
  const std::string* last_stock = nullptr;  // cuts of one board stand together
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    const Cut& cut = cuts_[i];
    if (cut.state == CutState::kWaiting || HasEnded(cut.state)) continue;
    Load& load = loads[{cut.bridge, cut.machine}];
    ++load.cuts;
    if (last_stock == nullptr || *last_stock != cut.stock) ++load.stock;
    last_stock = &cut.stock;
  }
  return loads;
}

std::vector<int> WorkOrder::GiveOut(const std::vector<MachineAddress>& attached) {
  std::vector<int> sent;
  if (state_ != OrderState::kReleased && state_ != OrderState::kInProgress) return sent;
  std::map<std::pair<std::string, std::string>, Load> loads = Loads();
  while (first_waiting_ < cuts_.size() && cuts_[first_waiting_].state != CutState::kWaiting) {
    ++first_waiting_;
  }
  for (std::size_t begin = first_waiting_; begin < cuts_.size();) {
    std::size_t end = begin + 1;
    while (end < cuts_.size() && cuts_[end].stock == cuts_[begin].stock) ++end;
    const MachineAddress* chosen = nullptr;
    Load* chosen_load = nullptr;
    bool any_free = false;
    for (const MachineAddress& machine : attached) {
      Load& load = loads[{machine.bridge, machine.machine}];
      if (load.stock >= kStockAhead) continue;
      any_free = true;
      if (machine.kind != cuts_[begin].kind) continue;
      if (chosen != nullptr &&
          std::pair(load.stock, load.cuts) >= std::pair(chosen_load->stock, chosen_load->cuts)) {
        continue;
      }
      chosen = &machine;
      chosen_load = &load;
    }
    if (!any_free) break;
    for (std::size_t i = begin; chosen != nullptr && i < end; ++i) {
      if (cuts_[i].state != CutState::kWaiting) continue;
      Cut& cut = cuts_[i];
      cut.state = CutState::kSent;
      cut.bridge = chosen->bridge;
      cut.machine = chosen->machine;
      cut.sequence = ++last_sequence_[{cut.bridge, cut.machine}];
      by_address_[{cut.bridge, cut.machine, cut.sequence}] = static_cast<int>(i);
      sent.push_back(static_cast<int>(i));
      ++chosen_load->cuts;
    }
    if (chosen != nullptr && cuts_[begin].state == CutState::kSent) ++chosen_load->stock;
    begin = end;
  }
  if (!sent.empty()) {
    given_out_ = true;
    state_ = OrderState::kInProgress;
  }
  return sent;
}

std::vector<int> WorkOrder::CutsToSendAgain(const std::string& bridge) const {
  std::vector<int> again;
  if (state_ != OrderState::kInProgress) return again;
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    if (cuts_[i].state == CutState::kSent && cuts_[i].bridge == bridge) {
      again.push_back(static_cast<int>(i));
    }
  }
  std::stable_sort(again.begin(), again.end(), [&](int a, int b) {
    return std::tie(cuts_[a].machine, cuts_[a].sequence) <
           std::tie(cuts_[b].machine, cuts_[b].sequence);
  });
  return again;
}

std::set<std::string> WorkOrder::Bridges() const {
  std::set<std::string> bridges;
  for (const Cut& cut : cuts_) {
    const bool in_hand = cut.state == CutState::kSent || cut.state == CutState::kAccepted;
    if (in_hand) bridges.insert(cut.bridge);
  }
  return bridges;
}

std::optional<int> WorkOrder::Accept(const std::string& bridge, const std::string& machine,
                                     int64_t sequence) {
  const auto found = by_address_.find({bridge, machine, sequence});
  if (found == by_address_.end()) return std::nullopt;
  Cut& cut = cuts_[found->second];
  if (cut.state != CutState::kSent) return std::nullopt;
  cut.state = CutState::kAccepted;
  return found->second;
}

std::optional<int> WorkOrder::Report(const std::string& bridge, const CutReport& report) {
  const auto found = by_address_.find({bridge, report.machine, report.sequence});
  if (found == by_address_.end()) return std::nullopt;
  Cut& cut = cuts_[found->second];
  if (HasEnded(cut.state)) return std::nullopt;
  cut.message = report.message;
  cut.seconds = report.seconds;
  switch (report.outcome) {
    case CutOutcome::kDone:
      cut.state = CutState::kCut;
      ++done_;
      break;
    case CutOutcome::kRejected:
      cut.state = CutState::kRejected;
      break;
    case CutOutcome::kFailed:
      cut.state = CutState::kFailed;
      break;
  }
  if (state_ == OrderState::kCancelled) return found->second;
  if (cut.state != CutState::kCut) state_ = OrderState::kFailed;
  if (done_ == static_cast<int>(cuts_.size())) state_ = OrderState::kCompleted;
  return found->second;
}

absl::Status WorkOrder::Hold(const std::string& name) {
  if (IsFinal(state_)) return AlreadyFinished(name, state_);
  state_ = OrderState::kHeld;
  return absl::OkStatus();
}

absl::Status WorkOrder::Resume(const std::string& name) {
  if (IsFinal(state_)) return AlreadyFinished(name, state_);
  state_ = given_out_ ? OrderState::kInProgress : OrderState::kReleased;
  return absl::OkStatus();
}

absl::Status WorkOrder::Cancel(const std::string& name) {
  if (state_ == OrderState::kCancelled) return absl::OkStatus();
  if (IsFinal(state_)) return AlreadyFinished(name, state_);
  state_ = OrderState::kCancelled;
  return absl::OkStatus();
}

std::string WorkOrder::Trouble() const {
  for (const Cut& cut : cuts_) {
    if (cut.state != CutState::kRejected && cut.state != CutState::kFailed) continue;
    return absl::StrCat("cut ", cut.sequence, " of machine ", cut.machine, " at bridge ",
                        cut.bridge, " (part ", cut.part, ", ", cut.stock, ") ",
                        cut.state == CutState::kRejected ? "was rejected" : "failed",
                        cut.message.empty() ? "" : ": ", cut.message);
  }
  return "";
}

}  // namespace mortise::fabplanner
