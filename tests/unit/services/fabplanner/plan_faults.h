// What is wrong with a pegged design and its plan, by geometry that shares nothing with the code
// that evaluates, checks and plans: parts are convex bodies given by half-spaces, holes are exact
// cylinders, and what comes apart is told by bodies that reach on for ever.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

constexpr double kTouch = 2e-6;  // m; bodies that reach into each other by less only touch

// A prism with a convex outline.
struct ConvexPart {
  std::string name;
  std::vector<Eigen::Vector3d> corners;
  std::vector<Eigen::Vector3d> normals;  // outwards
  std::vector<double> offsets;           // normal · x is at most this inside
  std::vector<Eigen::Vector3d> edges;
};

inline Eigen::Vector3d InSpace(const Part& part, double u, double v, double w) {
  Eigen::Vector3d point;
  point[(part.extrusion_axis + 1) % 3] = u;
  point[(part.extrusion_axis + 2) % 3] = v;
  point[part.extrusion_axis] = w;
  return point;
}

inline ConvexPart BodyOf(const Part& part, std::vector<std::string>& faults) {
  ConvexPart body;
  body.name = part.name;
  const Eigen::Vector3d along = InSpace(part, 0, 0, 1);
  body.edges = {along};
  body.normals = {along, -along};
  body.offsets = {part.to, -part.from};
  for (std::size_t i = 0; i < part.outline.size(); ++i) {
    const Eigen::Vector2d from = part.outline[i];
    const Eigen::Vector2d edge = part.outline[(i + 1) % part.outline.size()] - from;
    body.corners.push_back(InSpace(part, from.x(), from.y(), part.from));
    body.corners.push_back(InSpace(part, from.x(), from.y(), part.to));
    body.edges.push_back(InSpace(part, edge.x(), edge.y(), 0).normalized());
    body.normals.push_back(InSpace(part, edge.y(), -edge.x(), 0).normalized());
    body.offsets.push_back(body.normals.back().dot(body.corners.back()));
  }
  for (const Eigen::Vector3d& corner : body.corners) {
    for (std::size_t k = 0; k < body.normals.size(); ++k) {
      if (body.normals[k].dot(corner) < body.offsets[k] + kTouch) continue;
      faults.push_back(part.name + " is not convex, which these checks take parts to be");
      return body;
    }
  }
  return body;
}

// How far `mover`, on its way along `way` to infinity (or, where that is zero, where it is), is
// inside of `other` at least, along any axis that could part them; at most 0 where one does.
inline double Overlap(const ConvexPart& mover, const ConvexPart& other,
                      const Eigen::Vector3d& way) {
  const auto extent = [](const ConvexPart& body, const Eigen::Vector3d& axis) {
    std::pair<double, double> range{1e9, -1e9};
    for (const Eigen::Vector3d& corner : body.corners) {
      range.first = std::min(range.first, axis.dot(corner));
      range.second = std::max(range.second, axis.dot(corner));
    }
    return range;
  };
  double least = std::numeric_limits<double>::infinity();
  const auto try_axis = [&](Eigen::Vector3d axis) {
    if (axis.norm() < 1e-6) return;
    axis.normalize();
    auto [low, high] = extent(mover, axis);
    const auto [other_low, other_high] = extent(other, axis);
    if (axis.dot(way) > 1e-9) high = 1e9;
    if (axis.dot(way) < -1e-9) low = -1e9;
    least = std::min({least, high - other_low, other_high - low});
  };
  for (const ConvexPart* const body : {&mover, &other}) {
    for (const Eigen::Vector3d& normal : body->normals) try_axis(normal);
    for (const Eigen::Vector3d& edge : body->edges) try_axis(edge.cross(way));
    if (least <= 0) return least;
  }
  for (const Eigen::Vector3d& a : mover.edges) {
    for (const Eigen::Vector3d& b : other.edges) try_axis(a.cross(b));
  }
  return least;
}

// The far end of a hole.
inline Eigen::Vector3d EndOf(const Hole& hole) {
  return hole.position + hole.depth * hole.direction;
}

// How much wood there is at least between a hole and the part's surface, but for the face that it
// begins at; negative where the hole comes out. A cylinder's farthest point along n is that of its
// axis and radius · sin of the angle between them.
inline double WoodAround(const ConvexPart& body, const Hole& hole) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < body.normals.size(); ++k) {
    const double cosine = body.normals[k].dot(hole.direction);
    if (cosine < -1 + 1e-9) continue;  // the face that it begins at
    const double around = hole.diameter / 2 * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double farthest =
        std::max(body.normals[k].dot(hole.position), body.normals[k].dot(EndOf(hole)));
    least = std::min(least, body.offsets[k] - farthest - around);
  }
  return least;
}

// Whether two holes run into each other; holes that cross count as round at their ends.
inline bool Meet(const Hole& a, const Hole& b) {
  const double reach = (a.diameter + b.diameter) / 2 - kTouch;
  const Eigen::Vector3d between = b.position - a.position;
  if (between.norm() > a.depth + b.depth + reach) return false;
  const double cosine = a.direction.dot(b.direction);
  if (std::abs(cosine) > 1 - 1e-9) {
    const double begin = between.dot(a.direction), end = begin + cosine * b.depth;
    const double beside = (between - begin * a.direction).norm();
    return beside < reach && std::max(begin, end) > kTouch &&
           std::min(begin, end) < a.depth - kTouch;
  }
  // The distance from points of b's axis to a's is convex: thirds close in on the nearest.
  const auto distance = [&](double t) {
    const Eigen::Vector3d point = between + t * b.direction;
    return (point - std::clamp(point.dot(a.direction), 0.0, a.depth) * a.direction).norm();
  };
  double low = 0, high = b.depth;
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3;
    (distance(low + third) < distance(high - third) ? high -= third : low += third);
  }
  return distance((low + high) / 2) < reach;
}

// What is joined so far: each part by the first of those that it hangs together with.
class Joined {
 public:
  const std::string& Of(const std::string& part) const {
    const auto found = first_.find(part);
    return found == first_.end() ? part : found->second;
  }
  void Join(const std::string& a, const std::string& b) {
    const std::string to = Of(a), from = Of(b);
    first_[a] = first_[b] = first_[to] = to;
    for (auto& [part, first] : first_) {
      if (first == from) first = to;
    }
  }

 private:
  std::map<std::string, std::string> first_;
};

// That pegs of a step push what it brings together along one line, and that it comes apart along
// it.
inline void FindStepFaults(const Design& design, const FabricationPlan& plan,
                           const std::vector<ConvexPart>& bodies,
                           std::vector<std::string>& faults) {
  Joined joined;
  std::set<int> priorities;
  for (const Peg& peg : design.pegs) priorities.insert(peg.priority);
  if (priorities.size() != plan.steps.size()) faults.push_back("steps are not one a priority");
  for (const int priority : priorities) {
    std::map<std::pair<std::string, std::string>, Eigen::Vector3d> ways;
    for (const Peg& peg : design.pegs) {
      if (peg.priority != priority) continue;
      const std::pair sides(joined.Of(peg.part), joined.Of(peg.other_part));
      if (sides.first == sides.second) {
        faults.push_back(peg.connection + " joins what hangs together already");
      }
      const auto [way, is_new] = ways.emplace(sides, -peg.direction);
      if (!is_new && way->second.dot(-peg.direction) < 1 - 1e-9) {
        faults.push_back(peg.connection + " pushes along another line than its step");
      }
    }
    for (const auto& [sides, way] : ways) {
      for (const ConvexPart& mover : bodies) {
        if (joined.Of(mover.name) != sides.first) continue;
        for (const ConvexPart& other : bodies) {
          if (joined.Of(other.name) != sides.second) continue;
          if (Overlap(mover, other, way) <= kTouch) continue;
          faults.push_back(mover.name + " passes through " + other.name);
        }
      }
    }
    for (const Peg& peg : design.pegs) {
      if (peg.priority == priority) joined.Join(peg.part, peg.other_part);
    }
  }
  for (const ConvexPart& body : bodies) {
    if (joined.Of(body.name) != joined.Of(bodies.front().name)) {
      faults.push_back(body.name + " hangs loose");
    }
  }
}

// That each part is planned once, of boards and sheets that are large enough.
inline void FindPlanFaults(const Design& design, const FabricationPlan& plan,
                           std::vector<std::string>& faults) {
  std::map<std::string, int> made;
  for (const BoardLayout& board : plan.boards) {
    double end = 0;
    for (const BoardSegment& segment : board.segments) {
      ++made[segment.part];
      if (segment.start < end - kTouch) faults.push_back(segment.part + " overlaps on its board");
      end = segment.start + segment.length;
    }
    if (end > board.stock_length + kTouch) faults.push_back(board.label + " is too short");
  }
  for (const SheetLayout& sheet : plan.sheets) {
    const Eigen::AlignedBox2d whole(Eigen::Vector2d::Zero(),
                                    Eigen::Vector2d(sheet.length, sheet.width));
    std::vector<Eigen::AlignedBox2d> taken;
    for (const SheetPlacement& placement : sheet.placements) {
      ++made[placement.part];
      Eigen::AlignedBox2d box;
      for (const Eigen::Vector2d& point : placement.outline) box.extend(point);
      if (!whole.contains(box)) faults.push_back(placement.part + " is not on its sheet");
      for (const Eigen::AlignedBox2d& other : taken) {
        if (!box.intersection(other).isEmpty()) {
          faults.push_back(placement.part + " overlaps on its sheet");
        }
      }
      taken.push_back(box);
    }
  }
  for (const Part& part : design.parts) {
    if (made[part.name] != 1) faults.push_back(part.name + " is not cut once");
  }
  for (const PlannedPart& part : plan.parts) {
    if (!part.handwork.empty()) faults.push_back(part.part + " takes handwork: " + part.handwork);
    if (!part.beyond_machines.empty()) faults.push_back(part.part + " is beyond the machines");
  }
}

// Everything that is wrong, for people; nothing for a design that can be built.
inline std::vector<std::string> FaultsOf(const Design& design, const FabricationPlan& plan) {
  std::vector<std::string> faults;
  std::vector<ConvexPart> bodies;
  std::map<std::string, std::size_t> index;
  for (const Part& part : design.parts) {
    index[part.name] = bodies.size();
    bodies.push_back(BodyOf(part, faults));
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (Overlap(bodies[i], bodies[j], Eigen::Vector3d::Zero()) <= kTouch) continue;
      faults.push_back(bodies[i].name + " reaches into " + bodies[j].name);
    }
  }
  std::map<std::string, std::vector<const Hole*>> holes;
  for (const Hole& hole : plan.holes) holes[hole.part].push_back(&hole);
  std::size_t count = 0;
  for (const auto& [part, drilled] : holes) {
    count += drilled.size();
    for (std::size_t i = 0; i < drilled.size(); ++i) {
      if (WoodAround(bodies[index.at(part)], *drilled[i]) < kTouch) {
        faults.push_back("a hole of " + drilled[i]->connector + " comes out of " + part);
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (!Meet(*drilled[i], *drilled[j])) continue;
        faults.push_back("holes of " + drilled[i]->connector + " and " + drilled[j]->connector +
                         " meet in " + part);
      }
    }
  }
  if (count != 2 * design.pegs.size()) faults.push_back("not every peg has two holes");
  FindStepFaults(design, plan, bodies, faults);
  FindPlanFaults(design, plan, faults);
  return faults;
}

}  // namespace mortise::fabplanner
