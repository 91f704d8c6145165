// Says of which parts nothing holds together, each reason once.
#pragma once

#include <string>
#include <vector>

#include "services/composer/connecting/connect.h"
#include "services/composer/connecting/motions.h"

namespace mortise::composer {

// Two parts that are left without a connection.
struct LeftPair {
  // Why: nothing of the collection is for such parts, the original's does not fit, the nearest of
  // the collection does not.
  enum class Reason { kNoSuch, kOriginal, kNearest } reason = Reason::kNoSuch;
  std::string first;   // of the body
  std::string second;  // of the component
  std::string detail;  // what does not fit, for people
};

// Returns one warning for each reason, in the order of their first pairs: it names some of the
// pairs of that reason, and no others. Reasons are the same that read the same.
std::vector<ConnectionWarning> WarningsOf(const std::vector<LeftPair>& left);

// Returns the one warning of a component that is to move and that nothing lets move, of which these
// pairs, at least one, are left: by what it is to move, and what pairs have come to, of each reason
// the first, of the first two reasons. `name` is what it is called.
ConnectionWarning WarningOfMotion(const std::vector<LeftPair>& left, const std::string& name,
                                  const WantedMotion& motion);

}  // namespace mortise::composer
