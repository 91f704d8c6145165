// Says with which priority the parts of a design come in, and its connections are made, where its
// expert has given them (thesis §8.4.2), and which of these contradict each other.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "services/fabplanner/joining/assembly_units.h"
#include "services/fabplanner/joining/fixings.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// A priority and the part, by index, that it was given to. Lower ones come first.
struct PriorityTag {
  int priority = 0;  // 0 for none
  int part = -1;
};

class AssemblyPriorities {
 public:
  // `design` and `joints` are kept by reference.
  AssemblyPriorities(const Design& design, const Joints& joints);

  // Whether anything has a priority.
  bool any() const { return any_; }

  // The priority of a connection: that of the connecting parts it is made of.
  const PriorityTag& OfFixing(int fixing) const { return fixings_[fixing]; }

  // Returns the tags with which units come in among each other. A part has its own; what has none,
  // and a sub-assembly, the lowest of the connections that join it to others.
  std::vector<PriorityTag> OfUnits(const std::vector<AssemblyUnit>& units) const;

  // Returns the priorities of the connections between units.
  ConnectionPriorities BetweenUnits(const std::vector<AssemblyUnit>& units) const;

  // FAILED_PRECONDITION, reason PRIORITIES_CONTRADICT, naming the two and their priorities: where
  // connecting parts of one connection have several, or a part comes in after a connection that
  // holds it.
  absl::Status Check() const;

  // The same where a sub-assembly, which is built by itself before it is joined to others, has a
  // later priority within than that with which it is joined.
  absl::Status CheckBuilt(const std::vector<int>& parts, const std::string& name,
                          const PriorityTag& joined) const;

  // Returns the error of two units of which the shapes bring in `early` last.
  absl::Status Conflict(const PriorityTag& late, const std::vector<int>& late_parts,
                        const PriorityTag& early, const std::vector<int>& early_parts) const;

  // Returns the error of a peg that goes in with a part before its connection is due.
  absl::Status PegConflict(int fixing, int due) const;

 private:
  // "'top' (2)", or "'top' (2, by 'screw 3')".
  std::string Told(const PriorityTag& tag, const std::vector<int>& parts) const;

  const Design& design_;
  const Joints& joints_;
  std::vector<PriorityTag> fixings_;
  bool any_ = false;
};

}  // namespace mortise::fabplanner
