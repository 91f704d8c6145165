#include "services/interpolator/mapping/marked_surface.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/surface_check.h"

namespace mortise::interpolator {
namespace {

constexpr int kFewestPoints = 3;  // of a shell

using Side = std::pair<int, int>;
using PointNames = std::map<int, std::string>;  // by vertex

int VertexCount(const MarkedSurface& marked) {
  return static_cast<int>(marked.surface.vertices.cols());
}

absl::Status CheckPoints(const MarkedSurface& marked, const std::string& field) {
  std::set<std::string> names;
  std::set<int> vertices;
  for (std::size_t i = 0; i < marked.points.size(); ++i) {
    const ControlPoint& point = marked.points[i];
    const std::string path = absl::StrCat(field, ".points[", i, "]");
    if (point.vertex < 0 || point.vertex >= VertexCount(marked)) {
      return InvalidField(path + ".vertex", "there is no such vertex");
    }
    if (!names.insert(point.name).second) {
      return InvalidField(path + ".name", absl::StrCat("'", point.name, "' is there twice"));
    }
    if (!vertices.insert(point.vertex).second) {
      return InvalidField(path + ".vertex", "another control point is at the same vertex");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckPaths(const MarkedSurface& marked, const std::string& field) {
  std::set<Side> sides;
  for (Eigen::Index t = 0; t < marked.surface.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      sides.insert({marked.surface.triangles(k, t), marked.surface.triangles((k + 1) % 3, t)});
    }
  }
  std::set<int> points, taken;
  for (const ControlPoint& point : marked.points) points.insert(point.vertex);
  for (std::size_t i = 0; i < marked.paths.size(); ++i) {
    const std::vector<int>& way = marked.paths[i].vertices;
    const std::string path = absl::StrCat(field, ".paths[", i, "]");
    if (way.size() < 2 || points.count(way.front()) == 0 || points.count(way.back()) == 0) {
      return InvalidField(path, "it does not lead from control point to control point");
    }
    for (std::size_t k = 0; k + 1 < way.size(); ++k) {
      if (sides.erase({way[k], way[k + 1]}) + sides.erase({way[k + 1], way[k]}) != 2) {
        return InvalidField(absl::StrCat(path, ".vertices[", k, "]"),
                            "no free edge of the surface leads to the next vertex");
      }
      if (k == 0) continue;
      if (points.count(way[k]) > 0 || !taken.insert(way[k]).second) {
        return InvalidField(absl::StrCat(path, ".vertices[", k, "]"),
                            "the path meets a control point, another path or itself");
      }
    }
  }
  return absl::OkStatus();
}

// Joins paths of the same name at points that are not matched, until none are left to join.
class PathJoiner {
 public:
  PathJoiner(const MarkedSurface& marked, const PointNames& matched)
      : paths_(marked.paths), is_joined_(marked.paths.size(), false) {
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      for (const int end : {paths_[i].vertices.front(), paths_[i].vertices.back()}) {
        if (matched.count(end) == 0) at_[{paths_[i].name, end}].push_back(i);
      }
    }
  }

  std::vector<ControlPath> Join() {
    for (const auto& [place, ends] : at_) {
      if (ends.size() == 2) JoinAt(place.second, Current(ends[0]), Current(ends[1]));
    }
    std::vector<ControlPath> joined;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (!is_joined_[i]) joined.push_back(paths_[i]);
    }
    return joined;
  }

 private:
  // Returns the path that the i-th has become a piece of.
  std::size_t Current(std::size_t i) const {
    while (is_joined_[i]) i = piece_of_.at(i);
    return i;
  }

  void JoinAt(int vertex, std::size_t first, std::size_t second) {
    if (first == second) return;
    std::vector<int>& head = paths_[first].vertices;
    std::vector<int> tail = paths_[second].vertices;
    if (head.back() != vertex) std::reverse(head.begin(), head.end());
    if (tail.front() != vertex) std::reverse(tail.begin(), tail.end());
    head.insert(head.end(), tail.begin() + 1, tail.end());
    is_joined_[second] = true;
    piece_of_[second] = first;
  }

  std::vector<ControlPath> paths_;
  std::vector<bool> is_joined_;
  std::map<std::size_t, std::size_t> piece_of_;
  std::map<std::pair<std::string, int>, std::vector<std::size_t>> at_;
};

using PathKey = std::tuple<std::string, std::string, std::string>;

// Returns the joined paths between matched points, by name and ends, from the lower name to the
// higher. Rings at one point and paths that are not the only ones of their key are left out.
std::map<PathKey, std::vector<int>> MatchedPaths(const MarkedSurface& marked,
                                                 const PointNames& matched) {
  std::map<PathKey, std::vector<int>> paths;
  std::set<PathKey> ambiguous;
  for (const ControlPath& path : PathJoiner(marked, matched).Join()) {
    const auto from = matched.find(path.vertices.front()), to = matched.find(path.vertices.back());
    if (from == matched.end() || to == matched.end() || from == to) continue;
    const bool is_reversed = to->second < from->second;
    std::vector<int> way = path.vertices;
    if (is_reversed) std::reverse(way.begin(), way.end());
    const PathKey key{path.name, std::min(from->second, to->second),
                      std::max(from->second, to->second)};
    if (!paths.emplace(key, std::move(way)).second) ambiguous.insert(key);
  }
  for (const PathKey& key : ambiguous) paths.erase(key);
  return paths;
}

std::vector<int> ShellOfVertices(const mesh::SurfaceMesh& surface,
                                 const std::vector<Shell>& shells) {
  std::vector<int> shell(static_cast<std::size_t>(surface.vertices.cols()), -1);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    for (const int t : shells[s].triangles) {
      for (int k = 0; k < 3; ++k) {
        shell[static_cast<std::size_t>(surface.triangles(k, t))] = static_cast<int>(s);
      }
    }
  }
  return shell;
}

std::vector<int> Genera(const std::vector<Shell>& shells) {
  std::vector<int> genera;
  for (const Shell& shell : shells) genera.push_back(shell.genus);
  std::sort(genera.begin(), genera.end());
  return genera;
}

absl::Status TopologyDiffers(const std::string& message) {
  return PreconditionFailed("TOPOLOGY_DIFFERS", message);
}

absl::Status CheckShells(const MarkedSurface& source, const MarkedSurface& target,
                         const std::vector<Correspondence::Point>& points) {
  const std::vector<Shell> ours = ShellsOf(source.surface), theirs = ShellsOf(target.surface);
  if (ours.size() != theirs.size()) {
    return TopologyDiffers(
        absl::StrCat("the source has ", ours.size(), " shells, the target ", theirs.size()));
  }
  if (Genera(ours) != Genera(theirs)) {
    return TopologyDiffers(absl::StrCat("the source has ", Genera(ours).back(),
                                        " handles on a shell, the target ", Genera(theirs).back()));
  }
  const std::vector<int> our_shell = ShellOfVertices(source.surface, ours);
  const std::vector<int> their_shell = ShellOfVertices(target.surface, theirs);
  std::map<int, int> ours_to_theirs, theirs_to_ours, counts;
  for (const Correspondence::Point& point : points) {
    const int our = our_shell[static_cast<std::size_t>(point.source)];
    const int their = their_shell[static_cast<std::size_t>(point.target)];
    if (ours_to_theirs.emplace(our, their).first->second != their ||
        theirs_to_ours.emplace(their, our).first->second != our ||
        ours[static_cast<std::size_t>(our)].genus !=
            theirs[static_cast<std::size_t>(their)].genus) {
      return TopologyDiffers(
          absl::StrCat("point '", point.name, "' is on another shell of the target"));
    }
    ++counts[our];
  }
  for (std::size_t s = 0; s < ours.size(); ++s) {
    const int count = counts[static_cast<int>(s)];
    if (count >= kFewestPoints) continue;
    return PreconditionFailed(
        "TOO_FEW_POINTS",
        absl::StrCat("shell ", s, " of the source has ", count,
                     " control points that the target has too; it takes ", kFewestPoints));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckMarkedSurface(const MarkedSurface& marked, const std::string& field) {
  if (marked.surface.triangles.cols() == 0) {
    return InvalidField(field + ".surface", "it has no triangles");
  }
  const std::vector<mesh::SurfaceFault> faults = mesh::CheckSurface(marked.surface, 1);
  if (!faults.empty()) return InvalidField(field + ".surface", faults.front().message);
  MORTISE_RETURN_IF_ERROR(CheckPoints(marked, field));
  return CheckPaths(marked, field);
}

std::vector<Shell> ShellsOf(const mesh::SurfaceMesh& surface) {
  std::map<Side, int> owner;
  const auto count = static_cast<int>(surface.triangles.cols());
  for (int t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k) {
      owner[{surface.triangles(k, t), surface.triangles((k + 1) % 3, t)}] = t;
    }
  }
  std::vector<Shell> shells;
  std::vector<bool> is_found(static_cast<std::size_t>(count), false);
  for (int first = 0; first < count; ++first) {
    if (is_found[static_cast<std::size_t>(first)]) continue;
    Shell shell;
    std::set<int> vertices;
    shell.triangles = {first};
    is_found[static_cast<std::size_t>(first)] = true;
    for (std::size_t i = 0; i < shell.triangles.size(); ++i) {
      const int t = shell.triangles[i];
      for (int k = 0; k < 3; ++k) {
        vertices.insert(surface.triangles(k, t));
        const auto beyond =
            owner.find({surface.triangles((k + 1) % 3, t), surface.triangles(k, t)});
        if (beyond == owner.end() || is_found[static_cast<std::size_t>(beyond->second)]) continue;
        is_found[static_cast<std::size_t>(beyond->second)] = true;
        shell.triangles.push_back(beyond->second);
      }
    }
    // Euler: V − E + F = 2 − 2g, with 2E = 3F.
    const auto faces = static_cast<int>(shell.triangles.size());
    shell.genus = 1 - (static_cast<int>(vertices.size()) - faces / 2) / 2;
    shells.push_back(std::move(shell));
  }
  return shells;
}

absl::StatusOr<Correspondence> FindCorrespondence(const MarkedSurface& source,
                                                  const MarkedSurface& target) {
  std::map<std::string, int> targets;
  for (const ControlPoint& point : target.points) targets[point.name] = point.vertex;
  Correspondence both;
  PointNames in_source, in_target;
  for (const ControlPoint& point : source.points) {
    const auto match = targets.find(point.name);
    if (match == targets.end()) continue;
    both.points.push_back({point.name, point.vertex, match->second});
    in_source[point.vertex] = point.name;
    in_target[match->second] = point.name;
  }
  std::sort(both.points.begin(), both.points.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  MORTISE_RETURN_IF_ERROR(CheckShells(source, target, both.points));
  const std::map<PathKey, std::vector<int>> theirs = MatchedPaths(target, in_target);
  for (const auto& [key, way] : MatchedPaths(source, in_source)) {
    const auto match = theirs.find(key);
    if (match != theirs.end()) both.paths.push_back({std::get<0>(key), way, match->second});
  }
  return both;
}

}  // namespace mortise::interpolator
