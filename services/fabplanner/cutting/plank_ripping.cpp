#include "services/fabplanner/cutting/plank_ripping.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "services/fabplanner/cutting/bin_packing.h"

namespace mortise::fabplanner {
namespace {

constexpr double kUnitsPerMetre = 1e9;
constexpr int64_t kSearchSteps = 1'000'000;

int64_t ToUnits(double metres) { return std::llround(metres * kUnitsPerMetre); }

using Groups = std::vector<std::vector<int>>;  // strips of each plank

// Each plank gives strips of one width.
Groups OneWidthEach(const std::vector<int64_t>& sizes, int64_t capacity) {
  std::map<int64_t, std::vector<int>> by_size;
  for (std::size_t i = 0; i < sizes.size(); ++i) by_size[sizes[i]].push_back(static_cast<int>(i));
  Groups groups;
  for (const auto& [size, strips] : by_size) {
    const auto each = static_cast<std::size_t>(std::max<int64_t>(1, capacity / size));
    for (std::size_t i = 0; i < strips.size(); ++i) {
      if (i % each == 0) groups.emplace_back();
      groups.back().push_back(strips[i]);
    }
  }
  return groups;
}

}  // namespace

std::vector<RippedPlank> RipPlanks(const std::vector<double>& widths, double plank_width,
                                   double kerf) {
  // Each strip takes its blade along, of which the last has none.
  std::vector<int64_t> sizes;
  for (const double width : widths) sizes.push_back(ToUnits(width) + ToUnits(kerf));
  int64_t capacity = ToUnits(plank_width) + ToUnits(kerf);
  if (!sizes.empty()) capacity = std::max(capacity, *std::max_element(sizes.begin(), sizes.end()));
  Groups groups = OneWidthEach(sizes, capacity);
  const Packing packing = PackBins(sizes, {{.capacity = capacity, .cost = 1}}, kSearchSteps);
  if (packing.bins.size() < groups.size()) {
    groups.clear();
    for (const PackedBin& bin : packing.bins) groups.push_back(bin.items);
  }
  std::vector<RippedPlank> planks;
  for (std::vector<int>& group : groups) {
    RippedPlank& plank = planks.emplace_back();
    double position = 0;
    for (const int strip : group) {
      plank.positions.push_back(position);
      position += widths[static_cast<std::size_t>(strip)] + kerf;
    }
    plank.strips = std::move(group);
  }
  return planks;
}

}  // namespace mortise::fabplanner
