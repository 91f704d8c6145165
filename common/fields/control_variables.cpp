#include "common/fields/control_variables.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/mesh/edge_sampling.h"
#include "common/mesh/face_edges.h"

namespace mortise::fields {
namespace {

constexpr double kSpacing = 0.25;  // of the diagonal

// Cuts the paths by nodes where points are, and samples their pieces.
class PathPieces {
 public:
  PathPieces(const DesignFields& design, mesh::ControlVariables& variables)
      : design_(design), spacing_(ControlSpacing(design.nodes)), variables_(variables) {
    for (std::size_t i = 0; i < variables.points.size(); ++i) {
      names_.insert(variables.points[i].name);
      if (variables.points[i].vertex >= 0) {
        point_at_.emplace(variables.points[i].vertex, static_cast<int>(i));
      }
    }
  }

  absl::Status Add(const Path& path) {
    const int from = EndPoint(path.nodes.front(), absl::StrCat(path.id, " from"));
    const int to = EndPoint(path.nodes.back(), absl::StrCat(path.id, " to"));
    std::vector<int> piece = {path.nodes.front()};
    int begin = from;
    for (std::size_t i = 1; i < path.nodes.size(); ++i) {
      piece.push_back(path.nodes[i]);
      const bool is_last = i + 1 == path.nodes.size();
      const auto found = point_at_.find(path.nodes[i]);
      if (!is_last && found == point_at_.end()) continue;
      const int end = is_last ? to : found->second;
      MORTISE_RETURN_IF_ERROR(AddPiece(path.id, piece, begin, end));
      piece = {path.nodes[i]};
      begin = end;
    }
    return absl::OkStatus();
  }

 private:
  // The point at the node, which becomes one if there is none; −1 if its name is another's.
  int EndPoint(int node, const std::string& name) {
    const auto found = point_at_.find(node);
    if (found != point_at_.end()) return found->second;
    if (!names_.insert(name).second) return -1;
    variables_.points.push_back({name, design_.nodes.col(node), node});
    return point_at_[node] = static_cast<int>(variables_.points.size()) - 1;
  }

  absl::Status AddPiece(const std::string& id, const std::vector<int>& nodes, int from, int to) {
    mesh::NamedEdge edge;
    edge.name = id;
    if (from >= 0 && to >= 0) {
      const auto& points = variables_.points;
      edge.name = absl::StrCat(id, " from ", points[static_cast<std::size_t>(from)].name, " to ",
                               points[static_cast<std::size_t>(to)].name);
    }
    edge.from = from;
    edge.to = to;
    edge.is_closed = nodes.front() == nodes.back();
    edge.way = mesh::WayAlong(design_.nodes(Eigen::all, nodes), edge.length);
    // No point may get a name that another has, as of a piece that has been there already.
    const auto [at, is_new] = names_.insert(edge.name + " at");
    const auto next = std::next(at);
    if (!is_new || (next != names_.end() && next->starts_with(*at))) return absl::OkStatus();
    const std::size_t first = variables_.paths.size();
    MORTISE_RETURN_IF_ERROR(mesh::SampleEdge(edge, spacing_, variables_));
    for (std::size_t i = first; i < variables_.paths.size(); ++i) variables_.paths[i].edge = id;
    return absl::OkStatus();
  }

  const DesignFields& design_;
  const double spacing_;
  mesh::ControlVariables& variables_;
  std::set<std::string> names_;
  std::map<int, int> point_at_;  // by node
};

// The outer triangles, each in a face named by its regions, and by its part where there are
// several.
mesh::FacedSurface OuterFaces(const DesignFields& design) {
  std::vector<std::vector<std::string>> names(static_cast<std::size_t>(design.triangles.cols()));
  for (const Region& region : design.regions) {
    for (const int t : region.triangles) names[static_cast<std::size_t>(t)].push_back(region.name);
  }
  mesh::FacedSurface outer;
  outer.vertices = design.nodes;
  outer.triangles.resize(3, design.triangles.cols());
  std::map<std::string, int> face_of_name;
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < design.triangles.cols(); ++t) {
    const int back = design.triangle_back[t], front = design.triangle_front[t];
    if ((back < 0) == (front < 0)) continue;
    outer.triangles.col(count) = design.triangles.col(t).head<3>();
    if (back < 0) std::swap(outer.triangles(1, count), outer.triangles(2, count));
    ++count;
    std::vector<std::string>& of = names[static_cast<std::size_t>(t)];
    if (design.parts.size() > 1) {
      of.push_back(design.parts[static_cast<std::size_t>(std::max(back, front))]);
    }
    std::sort(of.begin(), of.end());
    const auto [face, is_new] =
        face_of_name.emplace(absl::StrJoin(of, " = "), std::ssize(outer.face_names));
    if (is_new) outer.face_names.push_back(face->first);
    outer.triangle_face.push_back(face->second);
  }
  outer.triangles.conservativeResize(3, count);
  return outer;
}

// Whether a design may have so many.
bool AreFew(const mesh::ControlVariables& variables) {
  Eigen::Index positions = 0;
  for (const mesh::ControlVariables::Path& path : variables.paths) positions += path.way.cols();
  return std::ssize(variables.points) <= kMaximumControls &&
         std::ssize(variables.paths) <= kMaximumControls && positions <= kMaximumPositions;
}

}  // namespace

double ControlSpacing(const Eigen::Matrix3Xd& nodes) {
  if (nodes.cols() == 0) return 0;
  return kSpacing * (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
}

void SetControlVariables(const mesh::ControlVariables& variables, DesignFields& design) {
  design.control_points.clear();
  design.ways.clear();
  if (!AreFew(variables)) return;
  std::vector<int> kept;  // of each point, its number among those that are kept; else -1
  for (const mesh::ControlVariables::Point& point : variables.points) {
    const bool is_kept = point.name.size() <= kMaximumNameLength;
    kept.push_back(is_kept ? static_cast<int>(design.control_points.size()) : -1);
    if (is_kept) design.control_points.push_back({point.name, point.position, point.vertex});
  }
  for (const mesh::ControlVariables::Path& path : variables.paths) {
    const int from = kept[static_cast<std::size_t>(path.from)];
    const int to = kept[static_cast<std::size_t>(path.to)];
    if (from < 0 || to < 0 || path.edge.size() > kMaximumNameLength) continue;
    design.ways.push_back({path.edge, from, to, path.way});
  }
}

absl::StatusOr<mesh::ControlVariables> ControlVariablesOf(const DesignFields& design) {
  if (design.control_points.empty() && design.paths.empty()) {
    const double spacing = ControlSpacing(design.nodes);
    if (!(spacing > 0)) return mesh::ControlVariables();
    return mesh::FindControlVariables(OuterFaces(design), spacing);
  }
  mesh::ControlVariables variables;
  for (const ControlPoint& point : design.control_points) {
    const bool has_node = point.node >= 0;
    variables.points.push_back(
        {point.id, has_node ? Eigen::Vector3d(design.nodes.col(point.node)) : point.position,
         point.node});
  }
  for (const ControlWay& way : design.ways) {
    variables.paths.push_back({way.edge, way.from, way.to, way.positions});
  }
  PathPieces pieces(design, variables);
  for (const Path& path : design.paths) MORTISE_RETURN_IF_ERROR(pieces.Add(path));
  return variables;
}

}  // namespace mortise::fields
