#include "hwbridge/cutting/cut_patience.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace mortise::hwbridge {

double DefaultCutPatience(const Job& job) {
  constexpr double kAtLeast = 300.0;     // s
  constexpr double kGenerosity = 5.0;    // times what a slow machine takes
  constexpr double kHandling = 10.0;     // s
  constexpr double kSlowFeed = 0.1;      // m/s
  constexpr double kSlowOutline = 0.01;  // m/s
  const double motion = job.kind == MachineKind::kChopSaw
                            ? std::max(job.position, job.length) / kSlowFeed
                            : OutlineLength(job.outline) / kSlowOutline;
  return std::max(kAtLeast, kGenerosity * (kHandling + motion));
}

CutPatience::CutPatience(std::optional<double> seconds, double longest_scan)
    : seconds_(seconds), longest_scan_(longest_scan) {}

void CutPatience::Renew() {
  key_.reset();
  worked_ = 0.0;
}

std::optional<std::string> CutPatience::Note(const CutOrder& order, PackMlState state, double now) {
  if (key_ != order.key) {
    Renew();
    key_ = order.key;
    last_ = now;
  }
  if (state == PackMlState::kExecute || IsActingState(state)) {
    worked_ += std::min(now - last_, longest_scan_);
  }
  last_ = now;
  const double patience = seconds_.value_or(DefaultCutPatience(order.job));
  if (worked_ < patience) return std::nullopt;
  return absl::StrCat("the machine has been at cut ", order.key.sequence, " of ",
                      order.key.work_order, " for ", patience, " s and has not ended it, and is ",
                      PackMlStateName(state), "; look at the machine");
}

}  // namespace mortise::hwbridge
