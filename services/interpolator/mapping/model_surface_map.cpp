#include "services/interpolator/mapping/model_surface_map.h"

#include <utility>

#include "common/base/errors.h"
#include "services/interpolator/mapping/between_parts.h"
#include "services/interpolator/mapping/control_points.h"

namespace mortise::interpolator {
namespace {

absl::Status CheckSizes(const ModelSurface& model, const std::string& field) {
  const Eigen::Index count = model.surface.triangles.cols();
  const bool has_corners =
      count == 0 || (model.surface.triangles.minCoeff() >= 0 &&
                     model.surface.triangles.maxCoeff() < model.surface.vertices.cols());
  if (!has_corners || !model.surface.vertices.allFinite()) {
    return InvalidField(field + ".surface", "a triangle names no vertex, or one is not finite");
  }
  if (model.front.size() != model.back.size() ||
      (model.front.size() != 0 && model.front.size() != count)) {
    return InvalidField(field + ".front", "there is not one part of each triangle");
  }
  const bool has_middles = model.middles.cols() == 0 ||
                           (model.middles.cols() == count && model.middles.minCoeff() >= 0 &&
                            model.middles.maxCoeff() < model.surface.vertices.cols());
  if (has_middles) return absl::OkStatus();
  return InvalidField(field + ".middles", "they are not three vertices of each triangle");
}

// Returns the triangles that are on the outside, or those that are not.
std::vector<int> Triangles(const ModelSurface& model, bool on_outside) {
  std::vector<int> triangles;
  for (int t = 0; t < static_cast<int>(model.surface.triangles.cols()); ++t) {
    const bool is_outside = model.front.size() == 0 || model.front[t] < 0;
    if (is_outside == on_outside) triangles.push_back(t);
  }
  return triangles;
}

// The outside, with and without its control variables.
struct Outside {
  OuterSurface outer;
  MarkedSurface marked;
};

absl::StatusOr<Outside> OutsideOf(const ModelSurface& model, const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckSizes(model, field));
  const std::vector<int> triangles = Triangles(model, true);
  Eigen::Matrix3Xi middles;
  if (model.middles.cols() > 0) middles = model.middles(Eigen::all, triangles);
  Outside outside;
  outside.outer = MakeOuterSurface(model.surface.vertices,
                                   model.surface.triangles(Eigen::all, triangles), middles);
  auto marked = PlaceControlVariables(outside.outer.marked.surface, model.variables);
  if (!marked.ok()) return UnderField(field, marked.status());
  outside.marked = *std::move(marked);
  return outside;
}

PartTriangles BetweenParts(const ModelSurface& model) {
  const std::vector<int> triangles = Triangles(model, false);
  PartTriangles between;
  between.surface.vertices = model.surface.vertices;
  between.surface.triangles = model.surface.triangles(Eigen::all, triangles);
  for (const int t : triangles) {
    between.parts.emplace_back(std::min(model.back[t], model.front[t]),
                               std::max(model.back[t], model.front[t]));
  }
  return between;
}

void HalveSides(const ModelSurface& target, Eigen::Matrix3Xd& positions) {
  for (Eigen::Index i = 0; i < target.middles.size(); ++i) {
    const auto& corners = target.surface.triangles.col(i / 3);
    positions.col(target.middles(i % 3, i / 3)) =
        (positions.col(corners[i % 3]) + positions.col(corners[(i + 1) % 3])) / 2;
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<const ModelSurfaceMapper>> ModelSurfaceMapper::Create(
    ModelSurface target, const LayoutOptions& layout) {
  MORTISE_ASSIGN_OR_RETURN(Outside outside, OutsideOf(target, "target"));
  auto mapper = std::unique_ptr<ModelSurfaceMapper>(new ModelSurfaceMapper);
  mapper->target_ = std::move(target);
  mapper->outer_ = std::move(outside.outer);
  mapper->marked_ = std::move(outside.marked);
  mapper->layout_ = layout;
  return mapper;
}

absl::StatusOr<ModelSurfaceMap> ModelSurfaceMapper::Map(const ModelSurface& source) const {
  MORTISE_ASSIGN_OR_RETURN(const Outside ours, OutsideOf(source, "source"));
  ModelSurfaceMap map;
  MORTISE_ASSIGN_OR_RETURN(map.surface, MapSurface(ours.marked, marked_, layout_));
  const std::size_t count = outer_.node.size();
  map.surface.places =
      PlacesBeforeMarking(ours.outer.marked.surface, ours.marked, map.surface, count);
  map.surface.positions.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(count));
  const std::vector<NodePlace> places = PlacesInNodes(ours.outer, map.surface.places);
  FollowCurvedSides(source.surface.vertices, ours.outer, map.surface);
  JoinSheets(outer_, map.surface.positions);
  map.positions = target_.surface.vertices;
  map.places.resize(static_cast<std::size_t>(map.positions.cols()));
  std::vector<bool> is_known(map.places.size(), false);
  for (std::size_t v = 0; v < count; ++v) {
    const auto vertex = static_cast<std::size_t>(outer_.node[v]);
    map.positions.col(outer_.node[v]) = map.surface.positions.col(static_cast<Eigen::Index>(v));
    map.places[vertex] = places[v];
    is_known[vertex] = true;
  }
  MORTISE_ASSIGN_OR_RETURN(map.between_parts,
                           FollowBetweenParts(BetweenParts(source), BetweenParts(target_),
                                              source.surface, is_known, map.positions, map.places));
  HalveSides(target_, map.positions);
  return map;
}

}  // namespace mortise::interpolator
