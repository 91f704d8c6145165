// Says for people what is unusual about a front.
#pragma once

#include <string>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/front/front.h"

namespace mortise::pareto {

// Remarks that a metric is the same for all designs, or that one design is the best in all metrics,
// so that there is nothing to trade. `names` are the metrics'.
std::vector<std::string> FrontRemarks(const Archive& archive, const Front& front,
                                      const std::vector<std::string>& names);

}  // namespace mortise::pareto
