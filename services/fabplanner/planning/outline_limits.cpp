#include "services/fabplanner/planning/outline_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

constexpr double kStraight = 1e-6;      // rad
constexpr std::size_t kMostPlaces = 6;  // that a message names
constexpr double kSharp =
    40 * M_PI / 180;  // rad; no arc is drawn with fewer than three edges to 90°

// A bend of the outline around one or more of its inner corners.
struct Bend {
  std::size_t first = 0, last = 0;  // corners
  Eigen::Vector2d corner;           // where the edges before and behind it meet
  double turn = 0;                  // rad, inwards
  double radius = 0;                // m, of the arc in it; 0 for a corner
};

std::size_t Next(const Outline& outline, std::size_t i) { return (i + 1) % outline.size(); }
std::size_t Before(const Outline& outline, std::size_t i) {
  return (i + outline.size() - 1) % outline.size();
}

// By how much the outline turns at a corner, rad: inwards if over 0.
double TurnAt(const Outline& outline, std::size_t i) {
  const Eigen::Vector2d in = outline[i] - outline[Before(outline, i)];
  const Eigen::Vector2d out = outline[Next(outline, i)] - outline[i];
  return -std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
}

// What the saw leaves of a bend.
double LeftOf(const Bend& bend, double radius) {
  if (bend.radius >= radius) return 0;
  const double cosine = std::cos(bend.turn / 2);
  // Half a turn and more in less than the saw's width: it does not get in.
  if (bend.turn >= M_PI || cosine < 1e-3) return std::numeric_limits<double>::max();
  return (radius - bend.radius) * (1 / cosine - 1);
}

// The inner corners one after another, from behind an outer one, so that no run of them is split.
std::vector<std::size_t> Around(const Outline& outline) {
  std::size_t start = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (TurnAt(outline, i) < -kStraight) start = i;
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < outline.size(); ++i) order.push_back((start + i) % outline.size());
  return order;
}

// The radius of the arc that touches the edges before, between and behind two bends.
double RadiusBetween(const Bend& a, const Bend& b) {
  const auto tangent = [](const Bend& bend) { return std::tan(std::min(bend.turn, 3.1) / 2); };
  return (b.corner - a.corner).norm() / (tangent(a) + tangent(b));
}

// One bend in place of two neighbours: its corner is where the edges before and behind them meet.
Bend Joined(const Outline& outline, const Bend& a, const Bend& b) {
  Bend joined{a.first, b.last, Eigen::Vector2d((a.corner + b.corner) / 2), a.turn + b.turn,
              RadiusBetween(a, b)};
  for (const double radius : {a.radius, b.radius}) {
    if (radius > 0) joined.radius = std::min(joined.radius, radius);
  }
  const Eigen::Vector2d in = a.corner - outline[Before(outline, a.first)];
  const Eigen::Vector2d out = outline[Next(outline, b.last)] - b.corner;
  const double cross = in.x() * out.y() - in.y() * out.x();
  if (joined.turn < M_PI && cross != 0) {
    const Eigen::Vector2d off = b.corner - a.corner;
    joined.corner = a.corner + in * ((off.x() * out.y() - off.y() * out.x()) / cross);
  }
  return joined;
}

// The bends that the saw takes.
std::vector<Bend> BendsOf(const Outline& outline, double radius) {
  std::vector<Bend> bends;
  std::size_t run = 0;  // first of the bends since the last outer corner
  for (const std::size_t i : Around(outline)) {
    const double turn = TurnAt(outline, i);
    if (std::abs(turn) <= kStraight) continue;
    if (turn < 0) {
      run = bends.size();
      continue;
    }
    Bend bend{i, i, outline[i], turn, 0};
    while (bends.size() > run && RadiusBetween(bends.back(), bend) < radius) {
      bend = Joined(outline, bends.back(), bend);
      bends.pop_back();
    }
    bends.push_back(bend);
  }
  return bends;
}

std::string PlaceText(const Eigen::Vector2d& point) {
  return absl::StrCat(Millimetres(point.x()), ", ", Millimetres(point.y()), " mm");
}

// One limit for all places of a kind.
MachineLimit LimitAt(const char* one, const char* several, const std::vector<std::string>& places,
                     double value, double radius) {
  MachineLimit limit;
  limit.kind = MachineLimit::Kind::kRadius;
  std::vector<std::string> named(
      places.begin(),
      places.begin() + static_cast<std::ptrdiff_t>(std::min(places.size(), kMostPlaces)));
  if (named.size() < places.size()) {
    named.push_back(absl::StrCat(places.size() - named.size(), " more"));
  }
  limit.place =
      absl::StrCat(places.size() == 1 ? one : several, " at ", absl::StrJoin(named, "; "));
  limit.value = value;
  limit.limit = radius;
  return limit;
}

}  // namespace

std::vector<MachineLimit> OutlineLimits(const Outline& outline, double radius) {
  std::vector<std::string> corners, arcs;
  double least = std::numeric_limits<double>::max();
  for (const Bend& bend : BendsOf(outline, radius)) {
    if (LeftOf(bend, radius) <= kCornerTolerance) continue;
    bool is_sharp = false;
    const auto is_corner = [&](std::size_t i) {
      return bend.first == bend.last || TurnAt(outline, i) >= kSharp;
    };
    for (std::size_t i = bend.first;; i = Next(outline, i)) {
      if (is_corner(i)) {
        corners.push_back(PlaceText(outline[i]));
        is_sharp = true;
      }
      if (i == bend.last) break;
    }
    if (is_sharp) continue;
    arcs.push_back(PlaceText((outline[bend.first] + outline[bend.last]) / 2));
    least = std::min(least, bend.radius);
  }
  std::vector<MachineLimit> limits;
  if (!corners.empty()) {
    limits.push_back(LimitAt("inner corner", "inner corners", corners, 0, radius));
    limits.back().reason =
        absl::StrCat(corners.size() == 1 ? "is sharp" : "are sharp",
                     ", but the jigsaw leaves a radius of ", Millimetres(radius), " mm");
  }
  if (!arcs.empty()) {
    limits.push_back(LimitAt("inner arc", "inner arcs", arcs, least, radius));
    limits.back().reason = absl::StrCat(
        arcs.size() == 1 ? "has a radius of " : "have radii down to ", Millimetres(least),
        " mm, but the jigsaw follows ", Millimetres(radius), " mm at least");
  }
  return limits;
}

}  // namespace mortise::fabplanner
