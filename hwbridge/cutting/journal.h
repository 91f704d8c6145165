// The bridge's journal: which cuts it was given, which numbers it gave them, how they ended, and
// what of that the fabplanner knows. It is what makes a cut happen once although processes die.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/cutting/durable_log.h"
#include "hwbridge/registers/registers.h"

namespace mortise::hwbridge {

// Names a cut for ever: the fabplanner numbers the cuts of each machine within a work order.
struct CutKey {
  std::string work_order;  // workOrders/{id}
  std::string machine;
  std::int64_t sequence = 0;
  auto operator<=>(const CutKey&) const = default;
};

// A cut to make.
struct CutOrder {
  CutKey key;
  Job job;
};

// The decision to give a cut to its machine under a sequence number of the machine.
struct Intent {
  CutKey key;
  std::uint32_t number = 0;             // of the machine, growing
  std::uint32_t identity = 0;           // of the machine's memory when the intent was made
  std::uint32_t boot_epoch = 0;         // of the machine when the intent was made
  JobResult result = JobResult::kNone;  // kNone while it is open
  double seconds = 0.0;                 // s on the machine's clock
  bool accepted = false;                // the machine was seen to have taken the number
  std::string because = {};             // of result kUnknown, for people
};

// What a machine had said of itself when it was last written down: a machine that keeps its word
// never says less. Compared after a restart with what it says then.
struct RememberedEcho {
  std::uint32_t identity = 0;
  std::uint32_t boot_epoch = 0;
  std::uint32_t accepted = 0;           // the highest number seen to be taken
  std::uint32_t done = 0;               // the highest number seen to have ended
  JobResult result = JobResult::kNone;  // of `done`
  bool operator==(const RememberedEcho&) const = default;
};

enum class CutOutcome { kDone = 1, kRejected = 2, kFailed = 3 };

// How a cut ended, as told to the fabplanner.
struct CutReport {
  std::int64_t number = 0;  // 1, 2, 3 … of this journal
  CutKey key;
  CutOutcome outcome = CutOutcome::kDone;
  std::string message;
  double seconds = 0.0;
};

// Thread safe. Every Add… returns after the record is safe on disk; when it fails nothing changed.
class Journal {
 public:
  // Fails as DurableLog::Open does; DATA_LOSS naming the line where a record makes no sense.
  static absl::StatusOr<std::unique_ptr<Journal>> Open(const std::filesystem::path& path,
                                                       const DurableLog::Options& options = {});

  // A cut that was given before is not added again; returns whether it was new. INVALID_ARGUMENT as
  // EncodeJob.
  absl::StatusOr<bool> AddCut(const CutOrder& order);

  // The cuts of a machine that have no report, in the order they were given.
  std::vector<CutOrder> OpenCuts(std::string_view machine) const;

  absl::Status AddIntent(const Intent& intent);

  // The machine was seen to have taken the number, which must be that of the latest intent of its
  // cut; NOT_FOUND otherwise.
  absl::Status AddAcceptance(std::string_view machine, std::uint32_t number);

  // How the number ended; as AddAcceptance. `because` tells people why the result is kUnknown.
  absl::Status AddResult(std::string_view machine, std::uint32_t number, JobResult result,
                         double seconds, std::string_view because = "");

  // The intents of a cut, in order.
  std::vector<Intent> Intents(const CutKey& key) const;

  // The highest number ever given to the machine; 0 if none.
  std::uint32_t HighestNumber(std::string_view machine) const;

  // Someone vouches that everything the machine did up to `number` was not ours to count: later
  // intents have higher numbers.
  absl::Status AdoptNumber(std::string_view machine, std::uint32_t number);

  // The machine raised the alarm, for the reason that `because` tells people; it stands, also after
  // a restart, until ClearAlarm.
  absl::Status AddAlarm(std::string_view machine, std::string_view because);

  // A person has looked at the machine, which said `seen` then: what it may have said before no
  // longer counts.
  absl::Status ClearAlarm(std::string_view machine, const RememberedEcho& seen);

  // The alarm that stands at the machine; empty if none does.
  std::string Alarm(std::string_view machine) const;

  // Nothing before the first intent for the machine and the first alarm that was cleared.
  std::optional<RememberedEcho> LastEcho(std::string_view machine) const;

  // Ends a cut. FAILED_PRECONDITION if it has a report.
  absl::StatusOr<CutReport> AddReport(const CutKey& key, CutOutcome outcome,
                                      std::string_view message, double seconds);

  // Ends a cut that was never taken over, as rejected; does nothing if the cut is known.
  absl::Status AddRejection(const CutKey& key, std::string_view message);

  // In order of their numbers.
  std::vector<CutReport> UnacknowledgedReports() const;

  // The fabplanner stored all reports up to `number`.
  absl::Status AddAcknowledgement(std::int64_t number);

  std::int64_t NextReportNumber() const;

 private:
  struct Entry {
    CutOrder order;
    std::vector<Intent> intents;
    bool reported = false;
  };
  struct MachineBook {
    std::vector<CutKey> arrivals;             // of all cuts
    std::size_t first_open = 0;               // index in `arrivals` before which all are reported
    std::map<std::uint32_t, CutKey> numbers;  // which cut a number was given to
    std::uint32_t highest = 0;
    std::string alarm;  // empty while none stands
    std::optional<RememberedEcho> echo;
  };

  explicit Journal(std::unique_ptr<DurableLog> log);
  absl::Status Replay(const std::string& line);
  absl::Status Append(const std::string& line);
  absl::Status Apply(CutOrder order);
  absl::Status Apply(const Intent& intent);
  absl::Status Apply(const CutReport& report);
  static void Remember(MachineBook& book, const Intent& intent);
  absl::Status ApplyAcceptance(const std::string& machine, std::uint32_t number);
  absl::Status ApplyResult(const std::string& machine, std::uint32_t number, JobResult result,
                           double seconds, std::string because);
  absl::Status ApplyAcknowledgement(std::int64_t number);
  Intent* LatestIntent(std::string_view machine, std::uint32_t number);

  mutable std::mutex mutex_;
  std::unique_ptr<DurableLog> log_;                           // guarded by mutex_
  std::map<CutKey, Entry> cuts_;                              // guarded by mutex_
  std::map<std::string, MachineBook, std::less<>> machines_;  // guarded by mutex_
  std::map<std::int64_t, CutReport> unacknowledged_;          // guarded by mutex_
  std::int64_t next_report_ = 1;                              // guarded by mutex_
  std::int64_t acknowledged_ = 0;                             // guarded by mutex_
};

}  // namespace mortise::hwbridge
