#include "services/fabplanner/joining/joinery.h"

#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

// How far a point inside `box` is from leaving it along `direction`; negative outside.
double DepthAvailable(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& position,
                      const Eigen::Vector3d& direction) {
  double distance = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) continue;
    const double border = direction[axis] > 0 ? box.max()[axis] : box.min()[axis];
    distance = std::min(distance, (border - position[axis]) / direction[axis]);
  }
  return distance;
}

absl::Status CheckPeg(const Peg& peg) {
  const std::string field = absl::StrCat("connection ", peg.connection);
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!peg.position.allFinite() || !peg.direction.allFinite() ||
      std::abs(peg.direction.norm() - 1) > 1e-6) {
    return InvalidField(field, "has a peg without a finite position and a unit direction");
  }
  if (!positive(peg.diameter) || !positive(peg.length) || !positive(peg.depth_in_part) ||
      peg.depth_in_part >= peg.length) {
    return InvalidField(field, "has a peg whose diameter, length or depth in its part is unusable");
  }
  return absl::OkStatus();
}

absl::StatusOr<Hole> DrillHole(const Peg& peg, const std::string& part,
                               const std::map<std::string, Eigen::AlignedBox3d>& boxes,
                               const Eigen::Vector3d& direction, double peg_depth) {
  const auto box = boxes.find(part);
  if (box == boxes.end()) {
    return InvalidField(absl::StrCat("connection ", peg.connection),
                        absl::StrCat("joins the part ", part, ", which the design does not have"));
  }
  Hole hole{part, peg.position, direction, peg.diameter, peg_depth + kHoleClearance};
  hole.connector = peg.connection;
  const double available = DepthAvailable(box->second, peg.position, direction);
  if (hole.depth >= available) {
    const std::vector<std::string> depths =
        ComparedMillimetres({hole.depth, std::max(0.0, available)});
    return PreconditionFailed(
        "PEG_TOO_LONG",
        absl::StrCat("a peg of connection ", peg.connection, " needs a hole of ", depths[0],
                     " mm in part ", part, ", which is ", depths[1], " mm deep there"),
        part);
  }
  return hole;
}

}  // namespace

absl::StatusOr<std::vector<Hole>> HolesFor(const Design& design) {
  std::map<std::string, Eigen::AlignedBox3d> boxes;
  for (const Part& part : design.parts) boxes[part.name] = BoundsOf(part);
  std::vector<Hole> holes;
  holes.reserve(2 * design.pegs.size());
  for (const Peg& peg : design.pegs) {
    MORTISE_RETURN_IF_ERROR(CheckPeg(peg));
    MORTISE_ASSIGN_OR_RETURN(Hole own,
                             DrillHole(peg, peg.part, boxes, -peg.direction, peg.depth_in_part));
    MORTISE_ASSIGN_OR_RETURN(Hole other, DrillHole(peg, peg.other_part, boxes, peg.direction,
                                                   peg.length - peg.depth_in_part));
    holes.push_back(std::move(own));
    holes.push_back(std::move(other));
  }
  return holes;
}

std::map<std::string, int> CountPegs(const Design& design) {
  std::map<std::string, int> counts;
  for (const Peg& peg : design.pegs) ++counts[peg.item];
  return counts;
}

}  // namespace mortise::fabplanner
