#include "services/composer/holding/standing_in_poses.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/assembly/model/rest_pose.h"
#include "common/design/evaluation.h"
#include "common/mesh/mass_properties.h"

namespace mortise::composer {
namespace {

using parametric::EvaluatedDesign;
using parametric::Pose;

// What stands, part by part: in one pose of a design.
struct Bodies {
  std::vector<mesh::SurfaceMesh> surfaces;
  std::vector<Eigen::Vector3d> centroids;
};

Bodies BodiesAsDrawn(const EvaluatedDesign& evaluated, const Eigen::Vector3d& shift) {
  Bodies bodies;
  for (const parametric::EvaluatedPart& part : evaluated.parts) {
    mesh::SurfaceMesh surface = parametric::PartSurface(part);
    surface.vertices.colwise() += shift;
    bodies.centroids.push_back(mesh::ComputeMassProperties(surface).centroid);
    bodies.surfaces.push_back(std::move(surface));
  }
  return bodies;
}

// Moves what a pose moves. The joint's centre is that of a design that is not shifted.
void Move(const Design& design, const Pose& pose, const std::vector<parametric::PlacedPart>& placed,
          Bodies& bodies) {
  const parametric::ParametricAssembly& assembly = *design.assembly;
  const Eigen::Isometry3d shifted(Eigen::Translation3d(design.shift));
  const Eigen::Isometry3d motion =
      shifted *
      parametric::MotionIn(pose, assembly.assembly(), assembly.elements().size(), design.q) *
      shifted.inverse();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto& element = assembly.elements()[static_cast<std::size_t>(placed[i].element)];
    if (!parametric::MovesIn(pose, assembly.assembly(), element)) continue;
    bodies.surfaces[i].vertices = (motion * bodies.surfaces[i].vertices).eval();
    bodies.centroids[i] = motion * bodies.centroids[i];
  }
}

PoseStanding Stand(const std::string& pose, const EvaluatedDesign& evaluated,
                   const Bodies& bodies) {
  PoseStanding stands;
  stands.pose = pose;
  for (std::size_t i = 0; i < bodies.centroids.size(); ++i) {
    stands.center_of_mass += evaluated.parts[i].mass * bodies.centroids[i];
  }
  if (evaluated.mass > 0) stands.center_of_mass /= evaluated.mass;
  stands.support = mesh::SupportOf(bodies.surfaces);
  stands.standing = mesh::StandOn(stands.support, stands.center_of_mass);
  return stands;
}

}  // namespace

ModelStanding StandingInPoses(const Design& design, const std::vector<parametric::Item>& items,
                              const std::vector<parametric::Material>& materials) {
  const parametric::ParametricAssembly& assembly = *design.assembly;
  const EvaluatedDesign evaluated = parametric::DesignAt(assembly, design.q, items, materials);
  const std::vector<parametric::PlacedPart> placed = assembly.PartsAt(design.q);
  ModelStanding found;
  found.mass = evaluated.mass;
  for (const parametric::EvaluatedPart& part : evaluated.parts) {
    if (!(part.mass > 0)) found.without_mass.push_back(part.name);
  }
  const Bodies drawn = BodiesAsDrawn(evaluated, design.shift);
  for (const Pose& pose : parametric::PosesOf(assembly.assembly())) {
    Bodies bodies = drawn;
    if (pose.joint >= 0) Move(design, pose, placed, bodies);
    found.poses.push_back(Stand(pose.name, evaluated, bodies));
  }
  return found;
}

std::size_t WorstPose(const ModelStanding& standing) {
  const auto worst = std::min_element(
      standing.poses.begin(), standing.poses.end(),
      [](const auto& a, const auto& b) { return a.standing.margin < b.standing.margin; });
  return static_cast<std::size_t>(worst - standing.poses.begin());
}

std::string DirectionName(const Eigen::Vector2d& falls_towards) {
  constexpr double kSome = 0.38;  // the sine of 22.5°, half way to the next of eight directions
  std::vector<std::string> words, axes;
  const auto add = [&](double along, const char* word, const char* axis) {
    if (along <= kSome) return;
    words.push_back(word);
    axes.push_back(axis);
  };
  add(-falls_towards.y(), "front", "-y");
  add(falls_towards.y(), "back", "+y");
  add(-falls_towards.x(), "left", "-x");
  add(falls_towards.x(), "right", "+x");
  if (words.empty()) return "to any side";
  const bool is_two = words.size() == 2;
  return absl::StrCat("to the ", words[0], is_two ? " " + words[1] : "", " (", axes[0],
                      is_two ? ", " + axes[1] : "", ")");
}

}  // namespace mortise::composer
