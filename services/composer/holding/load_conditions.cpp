#include "services/composer/holding/load_conditions.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/assembly/assembly_design.h"
#include "common/base/errors.h"
#include "services/composer/holding/bearing_surfaces.h"

namespace mortise::composer {
namespace {

using parametric::BoundaryCondition;
using parametric::BoundaryConditionKind;
using parametric::EvaluatedPart;

constexpr double kOnFloor = 1e-4;  // m
constexpr std::size_t kMaxLoadCases = 20;
constexpr char kGravity[] = "-9.81";  // m/s²

// The name of a level face of a part, at its lower or upper side; "" where it has none.
std::string LevelFace(const EvaluatedPart& part, bool upper) {
  const std::array<const char*, 2> of_box =
      upper ? std::array{"z_max", "cap"} : std::array{"z_min", "base"};
  for (const char* const name : of_box) {
    const auto& names = part.face_names;
    if (std::find(names.begin(), names.end(), name) == names.end()) continue;
    if (part.axis == parametric::Axis::kZ || name == of_box.front()) return name;
  }
  return "";
}

class Conditions {
 public:
  Conditions(const parametric::Assembly& drawn, const parametric::EvaluatedDesign& evaluated) {
    // Both are part by part in one order; only the drawing's names are those of the template.
    floor_ = evaluated.parts.front().minimum.z();
    for (std::size_t i = 0; i < evaluated.parts.size(); ++i) {
      parts_.emplace_back(drawn.parts[i].name, &evaluated.parts[i]);
      floor_ = std::min(floor_, evaluated.parts[i].minimum.z());
    }
  }

  double floor() const { return floor_; }

  absl::Status AddSupports() {
    for (const auto& [name, part] : parts_) {
      if (part->connecting || part->minimum.z() > floor_ + kOnFloor) continue;
      const std::string face = LevelFace(*part, false);
      if (face.empty()) continue;
      all_.push_back(
          {absl::StrCat("support of ", name), BoundaryConditionKind::kFixed, name, face, {}, ""});
    }
    if (!all_.empty()) return absl::OkStatus();
    return PreconditionFailed(
        "NO_SUPPORTS", "no principal part of the model stands on the floor with a level face",
        "name");
  }

  void AddGravity() {
    all_.push_back({"weight", BoundaryConditionKind::kGravity, "", "", {"0", "0", kGravity}, ""});
  }

  void AddLoad(const BearingSurface& surface, const std::string& load_case) {
    std::vector<std::pair<const std::pair<std::string, const EvaluatedPart*>*, double>> bearing;
    double area = 0;
    for (const auto& each : parts_) {
      if (std::find(surface.parts.begin(), surface.parts.end(), each.first) ==
              surface.parts.end() ||
          LevelFace(*each.second, true).empty()) {
        continue;
      }
      const Eigen::Vector3d size = each.second->maximum - each.second->minimum;
      bearing.emplace_back(&each, size.x() * size.y());
      area += bearing.back().second;
    }
    for (const auto& [part, share] : bearing) {
      all_.push_back({absl::StrCat(load_case, " on ", part->first),
                      BoundaryConditionKind::kForce,
                      part->first,
                      LevelFace(*part->second, true),
                      {"0", "0", absl::StrFormat("%.9g", -surface.Load() * share / area)},
                      load_case});
      has_load_ = true;
    }
  }

  absl::StatusOr<std::vector<BoundaryCondition>> Take() {
    if (has_load_) return std::move(all_);
    return PreconditionFailed(
        "NO_LOADS", "nothing of the model is a seat, step, shelf or top with a level face", "name");
  }

 private:
  double floor_ = 0;
  bool has_load_ = false;
  std::vector<std::pair<std::string, const EvaluatedPart*>> parts_;
  std::vector<BoundaryCondition> all_;
};

// What the load case of each surface is called.
std::vector<std::string> LoadCases(const std::vector<BearingSurface>& surfaces) {
  std::map<BearingKind, int> counts, numbers;
  for (const BearingSurface& surface : surfaces) ++counts[surface.kind];
  std::vector<std::string> names;
  for (const BearingSurface& surface : surfaces) {
    const std::string kind = BearingKindName(surface.kind);
    const bool is_numbered = counts[surface.kind] > 1 && surfaces.size() <= kMaxLoadCases;
    names.push_back(is_numbered ? absl::StrCat(kind, "_", ++numbers[surface.kind]) : kind);
  }
  return names;
}

}  // namespace

absl::StatusOr<std::vector<BoundaryCondition>> SupportsAndLoads(
    const Design& design, const std::vector<parametric::Item>& items) {
  MORTISE_ASSIGN_OR_RETURN(parametric::Assembly drawn, DrawnAt(design));
  for (parametric::AssemblyPart& part : drawn.parts) {
    part.box.minimum -= design.shift;
    part.box.maximum -= design.shift;
  }
  const parametric::EvaluatedDesign evaluated =
      parametric::DesignAt(*design.assembly, design.q, items, {});
  Conditions conditions(drawn, evaluated);
  MORTISE_RETURN_IF_ERROR(conditions.AddSupports());
  conditions.AddGravity();
  const std::vector<BearingSurface> surfaces = FindBearingSurfaces(drawn, conditions.floor());
  const std::vector<std::string> load_cases = LoadCases(surfaces);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    conditions.AddLoad(surfaces[i], load_cases[i]);
  }
  return conditions.Take();
}

}  // namespace mortise::composer
