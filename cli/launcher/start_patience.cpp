#include "cli/launcher/start_patience.h"

namespace mortise::cli {

StartPatience::StartPatience(Clock::time_point begin)
    : begin_(begin), moved_(begin), told_(begin) {}

StartPatience::Verdict StartPatience::Look(Clock::time_point now, std::int64_t progress) {
  if (progress != progress_) {
    progress_ = progress;
    moved_ = now;
  }
  if (now - begin_ >= kMost || now - moved_ >= kMostStill) return Verdict::kGiveUp;
  if (now - told_ < kTellEvery) return Verdict::kWait;
  told_ = now;
  return Verdict::kTell;
}

}  // namespace mortise::cli
