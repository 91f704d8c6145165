// A part of discovery that wants points evaluated: it asks, and is told.
//
// Many sources run side by side; each may have several points under way, so that their points fill
// the batches of many workers.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

class PointSource {
 public:
  virtual ~PointSource() = default;

  // Returns the next point (unit coordinates) to evaluate; nullopt while it waits for results, or
  // when it has finished.
  virtual std::optional<Eigen::VectorXd> Ask(Archive& archive) = 0;

  // Takes the result of an earlier point, as an entry of the archive, in the order asked for.
  virtual void Tell(Archive& archive, std::size_t entry) = 0;

  // Whether no more points will be asked for and none is under way.
  virtual bool Finished() const = 0;
};

}  // namespace mortise::pareto
