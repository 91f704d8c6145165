// A plan on its way through the machines: which cut stands where, and what is to be done next. A
// pure state machine: no clock, no store, no network.
//
// Exactly one effect a cut. A cut gets its machine and its sequence number once and keeps them; the
// pair is the key by which bridge and machine recognise a repetition. Numbers grow by one within a
// machine and work order. The caller stores a change before it tells anyone, so:
//   - a command that may or may not have arrived is sent again under the same number;
//   - a cut that the bridge has accepted is never sent again: its journal answers for it, and a
//     person must look if it never reports;
//   - a report is applied once: a cut that has ended stays as it is.
//
//   WAITING ──GiveOut──▶ SENT ──Accept──▶ ACCEPTED ──Report──▶ CUT, REJECTED or FAILED
//
// All cuts of one board or sheet go to one machine, in order, because it is loaded once. A machine
// has at most kStockAhead boards in hand, so that machines that attach later share the work.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "absl/status/status.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

inline constexpr int kStockAhead = 2;  // boards or sheets given to a machine at a time

enum class MachineKind { kChopSaw, kJigsaw };

enum class CutState { kWaiting, kSent, kAccepted, kCut, kRejected, kFailed };

enum class CutOutcome { kDone, kRejected, kFailed };

enum class OrderState { kReleased, kInProgress, kHeld, kCompleted, kFailed, kCancelled };

// Returns "released", "in progress" and so on, for messages.
const char* OrderStateName(OrderState state);

// Whether nothing more will be given out.
bool IsFinal(OrderState state);

// A machine behind a bridge.
struct MachineAddress {
  std::string bridge;
  std::string machine;
  MachineKind kind = MachineKind::kChopSaw;
};

// One cut and where it stands.
struct Cut {
  MachineKind kind = MachineKind::kChopSaw;
  std::string stock;                     // label of the board or sheet
  std::string part;                      // label of what results
  double position = 0;                   // crosscut: m, from the front end to the part's far side
  double length = 0;                     // crosscut: m, of what is cut off
  std::vector<Eigen::Vector2d> outline;  // outline: m, in the sheet's coordinates

  CutState state = CutState::kWaiting;
  std::string bridge;    // empty while it waits
  std::string machine;   // empty while it waits
  int64_t sequence = 0;  // 0 while it waits
  std::string message;   // details of how it ended
  double seconds = 0;    // duration on the machine's clock
};

// How a bridge says a cut ended.
struct CutReport {
  std::string machine;
  int64_t sequence = 0;
  CutOutcome outcome = CutOutcome::kDone;
  std::string message;
  double seconds = 0;
};

// Returns the cuts of a plan in cutting order, board by board and sheet by sheet. A board with a
// trim begins with a cut of its own, labelled "<board>.trim", whose blade takes the last of the
// trim. Machines cut square: boards with ends that are not are left to people.
std::vector<Cut> CutsFor(const FabricationPlan& plan);

class WorkOrder {
 public:
  // Makes a new order, or one as it was stored.
  explicit WorkOrder(std::vector<Cut> cuts, OrderState state = OrderState::kReleased);

  OrderState state() const { return state_; }
  const std::vector<Cut>& cuts() const { return cuts_; }
  int done() const { return done_; }

  // Gives waiting stock to the attached machines of its kind, those with the least in hand first,
  // and returns the indices of the cuts that are now SENT, in the order to send them. Nothing
  // unless RELEASED or IN_PROGRESS.
  std::vector<int> GiveOut(const std::vector<MachineAddress>& attached);

  // Returns the cuts to send again to a bridge that attaches or goes on: SENT and not accepted, in
  // order. Nothing unless IN_PROGRESS.
  std::vector<int> CutsToSendAgain(const std::string& bridge) const;

  // Returns the bridges that have cuts in hand.
  std::set<std::string> Bridges() const;

  // Takes note that the bridge has the cut in its journal. Returns the index of the cut if that is
  // news.
  std::optional<int> Accept(const std::string& bridge, const std::string& machine,
                            int64_t sequence);

  // Takes note that a cut ended. Returns the index of the cut if that is news; nothing for a
  // repetition or a cut that this order never gave out. The last cut completes the order; one that
  // was rejected or failed fails it, because a person must look before the stock is touched again.
  std::optional<int> Report(const std::string& bridge, const CutReport& report);

  // Pauses the order: nothing more is given out. OK if it is held already; FAILED_PRECONDITION,
  // reason WORK_ORDER_FINISHED, if it has ended. `name` is for messages.
  absl::Status Hold(const std::string& name);

  // Lets the order go on. OK if it is not held; FAILED_PRECONDITION as above.
  absl::Status Resume(const std::string& name);

  // Gives up: OK if it is cancelled already; FAILED_PRECONDITION if it has ended otherwise.
  absl::Status Cancel(const std::string& name);

  // Takes over a state that was stored meanwhile by Hold, Resume or Cancel.
  void Adopt(OrderState state) { state_ = state; }

  // Returns why it failed, for people: the first cut that did not work out; empty if none.
  std::string Trouble() const;

 private:
  using Address = std::tuple<std::string, std::string, int64_t>;  // bridge, machine, sequence

  struct Load {
    int stock = 0;  // boards and sheets with cuts that have not ended
    int cuts = 0;
  };
  std::map<std::pair<std::string, std::string>, Load> Loads() const;

  OrderState state_;
  std::vector<Cut> cuts_;
  int done_ = 0;
  bool given_out_ = false;
  std::size_t first_waiting_ = 0;  // cuts before it do not wait
  std::map<Address, int> by_address_;
  std::map<std::pair<std::string, std::string>, int64_t> last_sequence_;
};

}  // namespace mortise::fabplanner
