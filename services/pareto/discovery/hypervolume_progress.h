// Measures by the dominated hypervolume how a discovery gets on (Zitzler and Thiele 1999).
#pragma once

#include <cstddef>
#include <cstdint>

#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

// The reference point of the running hypervolume, in every scaled metric: a little beyond the
// nadir, so that the ends of the front count.
inline constexpr double kRunningReference = 1.1;

// Says how many samples a hypervolume of more than three metrics is measured with.
enum class HypervolumeSamples { kRunning = 1 << 12, kFinal = 1 << 18 };

// Returns the volume that the front of `archive` dominates up to `reference` in every metric, in
// performance scaled by `scaling`.
double DominatedVolume(const Archive& archive, const Scaling& scaling, double reference,
                       HypervolumeSamples samples);

// Returns the volume that `entry`, the last of `archive`, which nothing dominates, adds to what was
// dominated before, in the same measure up to kRunningReference. It is exact for up to four
// metrics, and a bound from above for more.
double GainedVolume(const Archive& archive, const Scaling& scaling, std::size_t entry);

// The hypervolume that is shown: measuring it takes a while, so while a discovery runs it is
// measured again only when there are a sixteenth more evaluations.
class ShownHypervolume {
 public:
  // Returns the dominated share of the box from ideal to nadir, 0 while nothing is feasible.
  double At(const Archive& archive, std::int64_t evaluations, bool has_finished);

  // Has it measured anew, whatever has been measured before.
  void Forget() { evaluations_ = -1; }

 private:
  std::int64_t evaluations_ = 0;  // when it was measured
  double hypervolume_ = 0;
};

}  // namespace mortise::pareto
