#include "services/fabplanner/documents/guide_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "common/base/errors.h"
#include "common/pages/number_pack.h"
#include "services/fabplanner/documents/part_mesh.h"

namespace mortise::fabplanner {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMostSteps = 65535;

// What stands in steps: a shape at a place.
struct Thing {
  std::uint32_t shape = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, the lower corner of its box
};

class ScenePacker {
 public:
  explicit ScenePacker(const std::vector<SceneStep>& steps) : steps_(steps) {}

  absl::StatusOr<GuideScene> Pack() {
    ReadShapes();
    GuideScene scene;
    scene.rounding = std::sqrt(3.0) * quantum_ / 2;
    for (const auto& [key, shape] : drawn_) AddThing(key, shape);
    Json steps = Json::array();
    for (const SceneStep& step : steps_) steps.push_back(PackStep(step));
    pages::NumberPack pack;
    pack.Add("corners", std::span<const std::uint8_t>(corners_));
    pack.Add("triangles", std::span<const std::uint32_t>(triangles_));
    pack.Add("thingShapes", std::span<const std::uint32_t>(thing_shapes_));
    pack.Add("thingPlaces", std::span<const float>(thing_places_));
    pack.Add("instances", std::span<const std::uint32_t>(instances_));
    pack.Add("instanceGroups", std::span<const std::uint32_t>(instance_groups_));
    pack.Add("groupOffsets", std::span<const float>(group_offsets_));
    pack.Add("groupRoles", std::span<const std::uint8_t>(group_roles_));
    pack.Add("arrows", std::span<const float>(arrows_));
    pack.Add("goals", std::span<const float>(goals_));
    MORTISE_ASSIGN_OR_RETURN(scene.pack, pack.Text());
    scene.description = {{"quantum", quantum_},
                         {"rounding", scene.rounding},
                         {"shapes", std::move(shapes_)},
                         {"steps", std::move(steps)},
                         {"lists", pack.lists()}};
    return scene;
  }

 private:
  // The shape of each part and peg of any step, by its address in the design, in order of
  // appearance: packs must not depend on addresses.
  void ReadShapes() {
    std::unordered_map<const void*, bool> seen;
    double longest = 0;
    const auto read = [&](const void* thing, auto make) {
      if (!seen.emplace(thing, true).second) return;
      render::Shape shape = make();
      if (shape.triangles.cols() == 0) return;
      const Eigen::Vector3d sides =
          shape.vertices.rowwise().maxCoeff() - shape.vertices.rowwise().minCoeff();
      longest = std::max(longest, sides.maxCoeff());
      drawn_.emplace_back(thing, std::move(shape));
    };
    for (const SceneStep& step : steps_) {
      for (const ArrangedPart& part : step.arrangement.parts) {
        read(part.part, [&] { return PartShape(*part.part, Eigen::Vector3d::Zero()); });
      }
      for (const ArrangedPeg& peg : step.arrangement.pegs) {
        read(peg.peg, [&] { return PegShape(*peg.peg, Eigen::Vector3d::Zero()); });
      }
    }
    quantum_ = longest > 0 ? longest / kMostSteps : 1;
  }

  void AddThing(const void* thing, const render::Shape& shape) {
    const Eigen::Vector3d low = shape.vertices.rowwise().minCoeff();
    std::vector<std::uint16_t> corners;
    corners.reserve(static_cast<std::size_t>(shape.vertices.size()));
    for (Eigen::Index v = 0; v < shape.vertices.cols(); ++v) {
      for (int c = 0; c < 3; ++c) {
        corners.push_back(
            static_cast<std::uint16_t>(std::lround((shape.vertices(c, v) - low[c]) / quantum_)));
      }
    }
    std::vector<std::uint32_t> triangles(shape.triangles.data(),
                                         shape.triangles.data() + shape.triangles.size());
    things_[thing] = static_cast<std::uint32_t>(thing_shapes_.size());
    thing_shapes_.push_back(ShapeOf(std::move(corners), std::move(triangles)));
    for (int c = 0; c < 3; ++c) thing_places_.push_back(static_cast<float>(low[c]));
  }

  // The number of a shape, which is new or was there.
  std::uint32_t ShapeOf(std::vector<std::uint16_t> corners, std::vector<std::uint32_t> triangles) {
    auto key = std::pair(std::move(corners), std::move(triangles));
    const auto known = known_shapes_.find(key);
    if (known != known_shapes_.end()) return known->second;
    const auto number = static_cast<std::uint32_t>(shapes_.size());
    shapes_.push_back({{"corners", corners_.size()},
                       {"nodes", key.first.size() / 3},
                       {"first", triangles_.size()},
                       {"indices", key.second.size()}});
    pages::AppendFolded(key.first, {}, 3, corners_);
    triangles_.insert(triangles_.end(), key.second.begin(), key.second.end());
    known_shapes_.emplace(std::move(key), number);
    return number;
  }

  Json PackStep(const SceneStep& step) {
    Json packed = {{"number", step.number},
                   {"view", {step.view.x(), step.view.y(), step.view.z()}},
                   {"firstInstance", instances_.size()},
                   {"firstGroup", group_roles_.size()},
                   {"firstArrow", arrows_.size() / 9},
                   {"firstGoal", goals_.size() / 9}};
    groups_.clear();
    for (const ArrangedPart& part : step.arrangement.parts) {
      AddInstance(part.part, part.role, part.offset);
    }
    for (const ArrangedPeg& peg : step.arrangement.pegs) {
      AddInstance(peg.peg, StepRole::kFastener, peg.offset);
    }
    for (const StepWay& way : step.arrangement.arrows) AddWay(way, arrows_);
    for (const StepWay& way : step.arrangement.goals) AddWay(way, goals_);
    packed["instances"] = instances_.size() - packed["firstInstance"].get<std::size_t>();
    packed["arrows"] = arrows_.size() / 9 - packed["firstArrow"].get<std::size_t>();
    packed["goals"] = goals_.size() / 9 - packed["firstGoal"].get<std::size_t>();
    return packed;
  }

  // What moves alike in a step is of one group.
  void AddInstance(const void* thing, StepRole role, const Eigen::Vector3d& offset) {
    const auto found = things_.find(thing);
    if (found == things_.end()) return;
    const auto key = std::tuple(role, offset.x(), offset.y(), offset.z());
    const auto [group, is_new] = groups_.emplace(key, static_cast<std::uint32_t>(groups_.size()));
    if (is_new) {
      group_roles_.push_back(static_cast<std::uint8_t>(role));
      for (int c = 0; c < 3; ++c) group_offsets_.push_back(static_cast<float>(offset[c]));
    }
    instances_.push_back(found->second);
    instance_groups_.push_back(group->second);
  }

  static void AddWay(const StepWay& way, std::vector<float>& list) {
    for (const Eigen::Vector3d& point : {way.place, way.from, way.to}) {
      for (int c = 0; c < 3; ++c) list.push_back(static_cast<float>(point[c]));
    }
  }

  const std::vector<SceneStep>& steps_;
  double quantum_ = 1;  // m
  std::vector<std::pair<const void*, render::Shape>> drawn_;
  std::map<std::pair<std::vector<std::uint16_t>, std::vector<std::uint32_t>>, std::uint32_t>
      known_shapes_;
  std::unordered_map<const void*, std::uint32_t> things_;
  std::map<std::tuple<StepRole, double, double, double>, std::uint32_t> groups_;  // of one step
  Json shapes_ = Json::array();
  std::vector<std::uint8_t> corners_;
  std::vector<std::uint32_t> triangles_, thing_shapes_, instances_, instance_groups_;
  std::vector<float> thing_places_, group_offsets_, arrows_, goals_;
  std::vector<std::uint8_t> group_roles_;
};

}  // namespace

absl::StatusOr<GuideScene> PackGuideScene(const std::vector<SceneStep>& steps) {
  return ScenePacker(steps).Pack();
}

}  // namespace mortise::fabplanner
