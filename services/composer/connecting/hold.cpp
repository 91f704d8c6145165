#include "services/composer/connecting/hold.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/linear_design.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::Axis;
using parametric::BoundingBox;
using parametric::ElementConnection;

constexpr double kMinDepth = 1e-4;  // m; what touches does not hold by depth

}  // namespace

std::vector<Hold> HoldsOf(const ElementConnection& connection) {
  std::vector<Hold> holds;
  const int principals = connection.principal_count();
  for (int c = principals; c < static_cast<int>(connection.elements.size()); ++c) {
    for (int p = 0; p < principals; ++p) {
      const BoundingBox& in = connection.elements[static_cast<std::size_t>(c)].box;
      const BoundingBox& of = connection.elements[static_cast<std::size_t>(p)].box;
      const Eigen::Vector3d common =
          in.maximum.cwiseMin(of.maximum) - in.minimum.cwiseMax(of.minimum);
      if (common.minCoeff() <= kMinDepth) continue;
      for (const Axis axis : parametric::kAxes) {
        const int a = static_cast<int>(axis);
        const bool from_below = in.minimum[a] < of.minimum[a] - connection.tolerance &&
                                in.maximum[a] < of.maximum[a] - connection.tolerance;
        const bool from_above = in.minimum[a] > of.minimum[a] + connection.tolerance &&
                                in.maximum[a] > of.maximum[a] + connection.tolerance;
        if (from_below || from_above) holds.push_back({c, p, axis, from_below, common[a]});
      }
    }
  }
  return holds;
}

std::string LooseHold(const ElementConnection& connection,
                      const parametric::OptimizedConnection& placed, double share) {
  for (const Hold& hold : HoldsOf(connection)) {
    const BoundingBox in = parametric::BoxOf(placed.q, hold.connecting);
    const BoundingBox of = parametric::BoxOf(placed.q, hold.principal);
    const int a = static_cast<int>(hold.axis);
    const double depth =
        hold.from_below ? in.maximum[a] - of.minimum[a] : of.maximum[a] - in.minimum[a];
    if (depth >= share * hold.depth - connection.tolerance) continue;
    return absl::StrCat("'", connection.elements[static_cast<std::size_t>(hold.connecting)].name,
                        "' would reach only ", Millimetres(std::max(depth, 0.0)), " of ",
                        Millimetres(hold.depth), " into what stands for '",
                        connection.elements[static_cast<std::size_t>(hold.principal)].name, "'");
  }
  return "";
}

}  // namespace mortise::composer
