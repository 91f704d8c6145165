// The shop floor: work orders under way and the bridges attached, brought together.
//
// The store is the truth. A change (an attachment, an acceptance, a report, a pause) is worked out
// on a copy of the order, stored with its events in one transaction, and only then kept in memory
// and told to the bridges: a command that was sent has always been stored before, and one that was
// stored but perhaps not sent is sent again when its bridge attaches. Killing the process at any
// point therefore loses nothing and doubles nothing.
//
// Cuts are written by the shop floor alone; an order's state also by the transactions of
// HoldWorkOrder and ResumeWorkOrder, after whose commit Refresh or Resumed is called.
//
// The shop floor waits for the store while it holds its own mutex. Whoever is within a transaction
// must therefore call none of its methods but OrdersUnderWay, or both wait for ever.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/stream_writer.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.pb.h"
#include "mortise/v1/hwbridge.pb.h"
#include "services/fabplanner/shop_floor/report_ledger.h"
#include "services/fabplanner/shop_floor/work_order.h"

namespace mortise::fabplanner {

// Thread safe.
class ShopFloor {
 public:
  using Writer = std::shared_ptr<rpc::StreamWriter<v1::PlannerMessage>>;

  // `store` must outlive it.
  explicit ShopFloor(store::Store* store) : store_(store) {}

  // Reads orders under way and known bridges from the store. Once, before anything else.
  absl::Status Open();

  // Takes note that a bridge attaches; an older stream of the same name is ended. Sends it what it
  // must know: the reports stored, pauses, commands that it has not accepted, new commands. Returns
  // the number of the attachment. INVALID_ARGUMENT naming the field of a bad hello;
  // FAILED_PRECONDITION, JOURNAL_LOST (report_ledger.h).
  absl::StatusOr<int64_t> Attach(const v1::BridgeMessage::Hello& hello, Writer writer);

  // Takes a later message of an attached bridge. Messages of a replaced attachment are ignored.
  absl::Status Receive(int64_t attachment, const v1::BridgeMessage& message);

  // Takes note that the stream of an attachment has ended.
  void Detach(int64_t attachment);

  // Takes an order up, or takes over its state as it is stored now, after a release or pause; tells
  // the bridges of the pause, or gives out cuts. NOT_FOUND.
  absl::Status Refresh(const std::string& order_name);

  // Does the same after a resumption: bridges that have cuts of the order are told to go on, those
  // that are away when they attach. Only a person's request leads here; a line that comes back does
  // not.
  absl::Status Resumed(const std::string& order_name);

  // Returns the machine of this name that raised the alarm, as its bridge last told. NOT_FOUND;
  // INVALID_ARGUMENT naming what is no name, or "bridge" if several have such a machine;
  // FAILED_PRECONDITION, NO_ALARM or BRIDGE_AWAY, for nobody should clear now what moves later.
  absl::StatusOr<v1::HeldMachine> FindAlarm(const std::string& bridge_name,
                                            const std::string& machine_name) const;

  // Tells the bridge that a person has looked at the machine, unless it has gone away since.
  void ClearAlarm(const std::string& bridge_name, const std::string& machine_name);

  // Gives an order up: its waiting cuts are never given out. No effect on a finished one.
  absl::Status Cancel(const std::string& order_name);

  // Where an order stands.
  struct Standing {
    OrderState state = OrderState::kReleased;
    int done = 0;
    int total = 0;
    std::string trouble;  // why it failed
    std::string held;     // which machines wait to be resumed, and why, for people
  };
  // Waits until the order differs from `known` or `timeout` has passed. Takes it up if needed.
  absl::StatusOr<Standing> WaitForChange(const std::string& order_name, const Standing& known,
                                         absl::Duration timeout);

  // Returns the machines that have cuts of the order in hand and are held. None for unknown orders
  // and those that have ended.
  std::vector<v1::HeldMachine> HeldMachines(const std::string& order_name) const;

  // Lets go of an order that has ended; what its bridges still report finds it in the store.
  void Forget(const std::string& order_name);

  // Orders taken up that have not ended. Waits for nothing, so a transaction may ask.
  int OrdersUnderWay() const { return orders_under_way_; }

  // Returns the bridges that were ever attached, by name.
  std::vector<v1::ListBridgesResponse::Bridge> Bridges() const;

 private:
  struct Order {
    v1::WorkOrder summary;  // as stored, without cuts
    WorkOrder work;
    // Bridges to tell, when they attach, that a person has resumed the order: those that were away,
    // or of which nothing was heard since they were told.
    std::set<std::string> to_resume = {};
  };
  struct Bridge {
    v1::ListBridgesResponse::Bridge stored;
    ReportLedger ledger;
    int64_t attachment = 0;  // 0: not attached
    Writer writer;
  };
  // What a change touches: indices of cuts.
  using Change = std::function<std::vector<int>(WorkOrder&)>;
  using Also = std::function<absl::Status(store::Transaction&)>;

  // All of these need mutex_.
  absl::StatusOr<Order*> FindOrder(const std::string& order_name);
  absl::Status Commit(Order* order, const Change& change, const Also& also = nullptr);
  absl::Status TakeOver(const std::string& order_name, bool resumed);
  void CountOrdersUnderWay();
  absl::Status GiveOutAll();
  std::vector<MachineAddress> AttachedMachines() const;
  std::vector<v1::HeldMachine> HeldMachinesOf(const Order& order) const;
  void SendCuts(const Order& order, const std::vector<int>& cuts);
  void SendPauses(Order& order, const std::string& only_bridge = "");
  void SendResume(Order& order, const std::string& bridge_name);
  absl::Status Accepted(Bridge& bridge, const v1::BridgeMessage::CommandAccepted& message);
  absl::Status Reported(Bridge& bridge, const v1::CutReport& message);
  void Acknowledge(Bridge& bridge);

  store::Store* const store_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Order> orders_;    // by name; guarded by mutex_
  std::atomic<int> orders_under_way_ = 0;  // of orders_; written under mutex_
  std::map<std::string, Bridge> bridges_;  // by name; guarded by mutex_
  int64_t last_attachment_ = 0;            // guarded by mutex_
};

}  // namespace mortise::fabplanner
