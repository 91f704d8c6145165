// Says which pieces of stock the parts of a plan are cut from, and how much of them each takes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// What is bought: an item in a size, µm.
using Ware = std::pair<std::string, std::array<int64_t, 3>>;

// `size`: length, width and thickness, m.
Ware WareOf(const std::string& item, const Eigen::Vector3d& size);

// Returns for each part of the design how many pieces of which stock all its copies take together.
// Each board, sheet and plank is shared between the parts that are cut from it, whole, by length
// times width; so the shares of a ware add up to its pieces. Nothing for parts that are not cut.
std::vector<std::map<Ware, double>> StockShares(const FabricationPlan& plan, const Design& design,
                                                const Items& items);

}  // namespace mortise::fabplanner
