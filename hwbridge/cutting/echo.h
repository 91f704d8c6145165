// What a machine's echo says: whether it can be believed, and what became of a number.
//
// A number that the bridge gave goes through the states below. What moves it on is an echo of the
// machine: the numbers `accepted` and `done`, read together. Each echo falls into one column; the
// empty corner is that there is no way back.
//
//   number n is         | accepted < n | accepted = n,  | accepted = n, | accepted > n, another  |
//                       |              | done < n       | done = n      | memory, contradictions |
//   --------------------+--------------+----------------+---------------+------------------------|
//   intended, unwritten | write        | unknown        | unknown       | unknown                |
//   perhaps written     | write again  | accepted       | ended         | unknown                |
//   accepted            | unknown      | wait           | ended         | unknown                |
//   ended, unknown      | (for good)                                                            |
//
// So a cut counts as made only where the machine has taken its number and ended that number; a
// number that the machine took is never written again; and what no machine that keeps its word can
// say ends as unknown, which a person settles who looks at the material.
#pragma once

#include <optional>
#include <string>

#include "hwbridge/cutting/journal.h"
#include "hwbridge/registers/registers.h"

namespace mortise::hwbridge {

// Why the echo contradicts itself, for people; nothing where it does not.
std::optional<std::string> ContradictionIn(const MachineStatus& status);

// Why no machine that keeps its word says `status` after `before`; nothing where one may.
std::optional<std::string> ContradictionBetween(const MachineStatus& before,
                                                const MachineStatus& status);

// Why no machine that keeps its word says `status` after what was last written down of it; nothing
// where one may.
std::optional<std::string> ContradictionWith(const RememberedEcho& remembered,
                                             const MachineStatus& status);

// Compares each echo with the last one that could be believed, the first with what the journal
// remembers.
class EchoWatch {
 public:
  explicit EchoWatch(std::optional<RememberedEcho> remembered = std::nullopt)
      : remembered_(remembered) {}

  // The contradiction in `status` or between it and the last; nothing if there is none. The next
  // one is compared with this one.
  std::optional<std::string> Note(const MachineStatus& status);

 private:
  std::optional<RememberedEcho> remembered_;  // until the first echo that could be believed
  std::optional<MachineStatus> last_;
};

enum class NumberStep {
  kWrite,    // the machine has not taken the number: it may be written (again)
  kWait,     // the machine has taken it and works on it
  kEnded,    // the machine has ended it; the status has the result
  kUnknown,  // the machine cannot tell what became of it
};

struct NumberVerdict {
  NumberStep step = NumberStep::kWrite;
  std::string because;  // of kUnknown, for people
};

// The cell of the table above for an open `intent`; `written`: its number may have been written.
// For an echo that contradicts neither itself nor the one before it.
NumberVerdict JudgeNumber(const Intent& intent, bool written, const MachineStatus& status);

}  // namespace mortise::hwbridge
