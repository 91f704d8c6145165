#include "services/fabplanner/plan/end_cuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"

namespace mortise::fabplanner {
namespace {

// The part's vertices in the board's axes: u from the foremost one, v and w from the middle line.
Eigen::Matrix3Xd AlongBoard(const Part& part, const Eigen::AlignedBox3d& box) {
  Eigen::Matrix3Xd points = part.vertices;
  if (!IsShaped(part)) {
    points.resize(3, static_cast<Eigen::Index>(2 * part.outline.size()));
    Eigen::Index column = 0;
    for (const Eigen::Vector2d& point : part.outline) {
      for (const double height : {part.from, part.to}) {
        points(part.extrusion_axis, column) = height;
        points((part.extrusion_axis + 1) % 3, column) = point.x();
        points((part.extrusion_axis + 2) % 3, column) = point.y();
        ++column;
      }
    }
  }
  Eigen::Matrix3d axes;  // rows: u, v, w
  axes.row(0) = Eigen::RowVector3d::Unit(part.length_axis);
  axes.row(2) = Eigen::RowVector3d::Unit(part.thickness_axis);
  axes.row(1) = axes.row(2).cross(axes.row(0));
  Eigen::Vector3d origin = box.center();
  origin[part.length_axis] = box.min()[part.length_axis];
  return axes * (points.colwise() - origin);
}

// A plane u = middle + slope · (v, w).
struct EndPlane {
  double middle = 0;
  EndSlope slope;

  double At(double v, double w) const { return middle + slope.across * v + slope.through * w; }
};

// The plane through one point on each of the section's corner lines, in the order (−, −), (+, −),
// (−, +), (+, +) of v and w; nothing if they lie in no plane.
std::optional<EndPlane> PlaneThrough(const std::array<double, 4>& at,
                                     const Eigen::Vector2d& section) {
  if (std::abs(at[0] - at[1] - at[2] + at[3]) > 2 * kEndTolerance) return std::nullopt;
  EndPlane plane;
  plane.middle = (at[0] + at[1] + at[2] + at[3]) / 4;
  const double rise_across = (at[1] + at[3] - at[0] - at[2]) / 2;
  const double rise_through = (at[2] + at[3] - at[0] - at[1]) / 2;
  if (std::abs(rise_across) > kEndTolerance) plane.slope.across = rise_across / section.x();
  if (std::abs(rise_through) > kEndTolerance) plane.slope.through = rise_through / section.y();
  return plane;
}

}  // namespace

double MitreOf(const EndSlope& end) { return std::atan(end.across); }

double BevelOf(const EndSlope& end) { return std::atan(end.through * std::cos(MitreOf(end))); }

EndSlope SlopeOf(double mitre, double bevel) {
  return {std::tan(mitre), std::tan(bevel) / std::cos(mitre)};
}

double ReachOf(const EndSlope& end, const Eigen::Vector2d& section) {
  return (std::abs(end.across) * section.x() + std::abs(end.through) * section.y()) / 2;
}

double KerfAlong(const EndSlope& end, double kerf) {
  return kerf * std::sqrt(1 + end.across * end.across + end.through * end.through);
}

CutEnds TurnedAboutLength(const CutEnds& ends) {
  const auto turned = [](const EndSlope& end) -> EndSlope {
    return {0 - end.across, 0 - end.through};
  };
  return {turned(ends.front), turned(ends.rear)};
}

CutEnds TurnedAboutWidth(const CutEnds& ends) {
  const auto turned = [](const EndSlope& end) -> EndSlope { return {0 - end.across, end.through}; };
  return {turned(ends.rear), turned(ends.front)};
}

CutEnds TurnedAboutThickness(const CutEnds& ends) {
  return TurnedAboutLength(TurnedAboutWidth(ends));
}

std::optional<CutEnds> EndsOf(const Part& part) {
  if (IsBox(part)) return CutEnds{};
  const Eigen::AlignedBox3d box = BoundsOf(part);
  const Eigen::Matrix3Xd points = AlongBoard(part, box);
  const Eigen::Vector3d sizes = box.sizes();
  const Eigen::Vector2d section(sizes[3 - part.length_axis - part.thickness_axis],
                                sizes[part.thickness_axis]);
  constexpr double kFar = std::numeric_limits<double>::max();
  std::array<double, 4> first = {kFar, kFar, kFar, kFar}, last = {-kFar, -kFar, -kFar, -kFar};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector2d off = points.col(i).tail<2>().cwiseAbs() - section / 2;
    if (off.cwiseAbs().maxCoeff() > kEndTolerance) continue;
    const std::size_t corner = (points(1, i) > 0 ? 1 : 0) + (points(2, i) > 0 ? 2 : 0);
    first[corner] = std::min(first[corner], points(0, i));
    last[corner] = std::max(last[corner], points(0, i));
  }
  if (*std::max_element(first.begin(), first.end()) == kFar) return std::nullopt;
  const auto front = PlaneThrough(first, section), rear = PlaneThrough(last, section);
  if (!front || !rear) return std::nullopt;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double v = points(1, i), w = points(2, i);
    if (points(0, i) < front->At(v, w) - 2 * kEndTolerance ||
        points(0, i) > rear->At(v, w) + 2 * kEndTolerance) {
      return std::nullopt;
    }
  }
  // What lies between the two planes and fills all of it is what lies between them.
  const double full = section.prod() * (rear->middle - front->middle);
  if (std::abs(VolumeOf(part) - full) > 1e-5 * full) return std::nullopt;
  return CutEnds{front->slope, rear->slope};
}

std::string DegreesText(double angle) {
  return absl::StrCat(std::round(angle * 1800 / M_PI) / 10, "°");
}

std::string EndText(const EndSlope& end) {
  if (IsSquare(end)) return "square";
  const std::string bevel =
      end.through == 0 ? "" : absl::StrCat("bevel ", DegreesText(std::abs(BevelOf(end))));
  if (end.across == 0) return bevel;
  return absl::StrCat(DegreesText(std::abs(MitreOf(end))), bevel.empty() ? "" : ", ", bevel);
}

std::string EndsText(const CutEnds& ends) {
  if (AreSquare(ends)) return "";
  const std::string front = EndText(ends.front), rear = EndText(ends.rear);
  return front == rear ? absl::StrCat("both ends ", front)
                       : absl::StrCat("ends ", front, " and ", rear);
}

}  // namespace mortise::fabplanner
