// What a check of a model finds: that it may topple, or that something may not hold.
#pragma once

#include <string>
#include <vector>

namespace mortise::composer {

enum class Severity {
  kNotice,   // good to know
  kWarning,  // may fail in use
  kFault,    // cannot work as it is
};

// "notice", "warning" or "fault".
const char* SeverityName(Severity severity);

struct Finding {
  Severity severity = Severity::kNotice;
  std::string rule;                // "edge-distance"; joint_rules.h and holding_report.h list them
  std::vector<std::string> parts;  // it is about these
  double found = 0;                // the number that is judged …
  double wanted = 0;               // … and what it should be at least
  std::string unit;                // of both: "m", "rad", "N", "d" (diameters), "1" (a number)
  std::string text;                // all of it, for people, without the parts' names
  std::string source;              // of the number that is wanted
};

// Joins findings that differ in their parts only, and puts the worst first; otherwise they stay in
// order.
std::vector<Finding> Ordered(std::vector<Finding> findings);

}  // namespace mortise::composer
