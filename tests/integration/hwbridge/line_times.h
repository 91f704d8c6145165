// How long the processes of these tests wait for each other's life signs.
#pragma once

namespace mortise::hwbridge {

// Times of the line between a bridge and real cell processes, in seconds. A computer that is busy
// for a while loses no patient line, so nobody needs to stand by to resume; on a hasty one the
// death of a process is noticed soon, and so is every hiccup.
struct LineTimes {
  double answer_timeout;
  double lost_after;
  double heartbeat_timeout;
};
inline constexpr LineTimes kPatientLine{10.0, 30.0, 60.0};
inline constexpr LineTimes kHastyLine{0.2, 0.4, 0.5};

}  // namespace mortise::hwbridge
