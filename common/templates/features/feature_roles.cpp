// Knows the roles of the faces of each kind of feature.
#include "common/templates/features/feature_roles.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace mortise::cad {
namespace {

constexpr std::array<std::string_view, 5> kHoleRoles = {"wall", "floor", "counterbore_wall",
                                                        "counterbore_floor", "countersink"};

bool IsSegmentOf(const SketchProfile& profile, const std::string& segment) {
  if (const auto* path = std::get_if<SketchPath>(&profile.shape)) {
    return std::any_of(path->segments.begin(), path->segments.end(), [&](const auto& candidate) {
      return segment == candidate.name ||
             (!candidate.round.empty() && segment == candidate.name + "_round");
    });
  }
  if (const auto* rectangle = std::get_if<SketchRectangle>(&profile.shape)) {
    for (const std::string side : {"bottom", "right", "top", "left"}) {
      if (segment == side || (!rectangle->round.empty() && segment == side + "_round")) return true;
    }
    return false;
  }
  return std::holds_alternative<SketchPolygon>(profile.shape) &&
         std::all_of(segment.begin(), segment.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// Whether `role` is a profile of the sketch, or one of its segments.
bool IsOfSketch(const std::string& sketch_name, const std::string& role,
                const FeaturesByName& earlier) {
  const auto feature = earlier.find(sketch_name);
  if (feature == earlier.end()) return true;
  const auto* sketch = std::get_if<Sketch>(&feature->second->kind);
  if (sketch == nullptr) return true;
  const std::size_t stop = role.find('.');
  const std::string profile_name = role.substr(0, stop);
  for (const SketchProfile& profile : sketch->profiles) {
    if (profile.name != profile_name) continue;
    return stop == std::string::npos || IsSegmentOf(profile, role.substr(stop + 1));
  }
  return false;
}

}  // namespace

bool MakesSolid(const Feature& feature) {
  return std::holds_alternative<Extrude>(feature.kind) ||
         std::holds_alternative<Revolve>(feature.kind) ||
         std::holds_alternative<Sweep>(feature.kind) || std::holds_alternative<Hole>(feature.kind);
}

bool Intersects(const Feature& feature) {
  const auto* extrude = std::get_if<Extrude>(&feature.kind);
  const auto* revolve = std::get_if<Revolve>(&feature.kind);
  const auto* sweep = std::get_if<Sweep>(&feature.kind);
  return (extrude != nullptr && extrude->operation == Operation::kIntersect) ||
         (revolve != nullptr && revolve->operation == Operation::kIntersect) ||
         (sweep != nullptr && sweep->operation == Operation::kIntersect);
}

bool MakesFace(const Feature& feature, const std::string& role, const FeaturesByName& earlier) {
  const bool is_cap = role == "start" || role == "end";
  if (const auto* extrude = std::get_if<Extrude>(&feature.kind)) {
    return role.empty() || is_cap || IsOfSketch(extrude->sketch, role, earlier);
  }
  if (const auto* revolve = std::get_if<Revolve>(&feature.kind)) {
    return role.empty() || (is_cap && !revolve->angle.empty()) ||
           IsOfSketch(revolve->sketch, role, earlier);
  }
  if (const auto* sweep = std::get_if<Sweep>(&feature.kind)) {
    return role.empty() || is_cap || IsOfSketch(sweep->sketch, role, earlier);
  }
  if (std::holds_alternative<Hole>(feature.kind)) {
    return role.empty() ||
           std::find(kHoleRoles.begin(), kHoleRoles.end(), role) != kHoleRoles.end();
  }
  const bool makes_faces = std::holds_alternative<Fillet>(feature.kind) ||
                           std::holds_alternative<Chamfer>(feature.kind) ||
                           std::holds_alternative<Shell>(feature.kind);
  return makes_faces && role.empty();
}

}  // namespace mortise::cad
