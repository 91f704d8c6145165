#include "services/composer/holding/holding_report.h"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/holding/joint_rules.h"
#include "services/composer/holding/loose_fasteners.h"

namespace mortise::composer {
namespace {

constexpr double kGravity = 9.81;                   // m/s²
constexpr double kDegree = std::numbers::pi / 180;  // rad
constexpr double kMinTilt = 10 * kDegree;           // of the floor
constexpr char kOwn[] = "our own rule of thumb";

std::string InPose(const PoseStanding& pose) {
  return pose.pose.empty() ? "" : absl::StrCat("in '", pose.pose, "' ");
}

void JudgeStanding(const ModelStanding& standing, std::vector<Finding>& findings) {
  for (const PoseStanding& pose : standing.poses) {
    const std::string way = DirectionName(pose.standing.falls_towards);
    if (pose.standing.margin <= 0) {
      findings.push_back(
          {Severity::kFault,
           "topples",
           {},
           pose.standing.margin,
           0,
           "m",
           absl::StrFormat("%sit topples %s: its weight is %.0f mm beyond what it stands on",
                           InPose(pose), way, -1000 * pose.standing.margin),
           "statics"});
    } else if (pose.standing.angle < kMinTilt) {
      findings.push_back(
          {Severity::kWarning,
           "tilts-easily",
           {},
           pose.standing.angle,
           kMinTilt,
           "rad",
           absl::StrFormat("%sit falls %s when it is tilted by %.1f degrees; %.0f wanted",
                           InPose(pose), way, pose.standing.angle / kDegree, kMinTilt / kDegree),
           kOwn});
    }
  }
  if (standing.without_mass.empty()) return;
  findings.push_back({Severity::kNotice, "mass-unknown", standing.without_mass, 0, 0, "kg",
                      "taken to weigh nothing: no material is known", "the items"});
}

// Where a load acts on a surface: on its edge, `inset` within, or in its middle.
std::vector<Eigen::Vector2d> PlacesOf(const BearingSurface& surface) {
  const Eigen::Vector2d middle = surface.box.center().head<2>();
  const BearingLoad& load = LoadOf(surface.kind);
  if (load.tipping_force == 0) return {middle};
  const Eigen::Vector2d reach =
      (surface.box.size().head<2>() / 2 - Eigen::Vector2d::Constant(load.tipping_inset))
          .cwiseMax(0);
  std::vector<Eigen::Vector2d> places;
  for (const double x : {-1, 0, 1}) {
    for (const double y : {-1, 0, 1}) {
      places.push_back(middle + reach.cwiseProduct(Eigen::Vector2d(x, y)));
    }
  }
  return places;
}

SurfaceCheck CheckSurface(BearingSurface surface, const ModelStanding& standing) {
  SurfaceCheck check;
  const BearingLoad& load = LoadOf(surface.kind);
  check.tipping_wanted = load.tipping_force > 0 ? load.tipping_force : surface.Load();
  check.tipping_at = surface.box.center().head<2>();
  const PoseStanding& drawn = standing.poses.front();
  for (const Eigen::Vector2d& place : PlacesOf(surface)) {
    const double force =
        mesh::TippingForce(drawn.support, drawn.center_of_mass, standing.mass * kGravity, place);
    if (force >= check.tipping_force) continue;
    check.tipping_force = force;
    check.tipping_at = place;
  }
  check.surface = std::move(surface);
  return check;
}

void JudgeSurface(const SurfaceCheck& check, std::vector<Finding>& findings) {
  if (check.tipping_force >= check.tipping_wanted) return;
  const BearingLoad& load = LoadOf(check.surface.kind);
  findings.push_back(
      {Severity::kWarning, "tips-under-load", check.surface.parts, check.tipping_force,
       check.tipping_wanted, "N",
       absl::StrFormat(
           "%.0f N %s tip the model over; it should bear %.0f N there", check.tipping_force,
           load.tipping_force > 0
               ? absl::StrFormat("%.0f mm from the edge of this %s", 1000 * load.tipping_inset,
                                 BearingKindName(check.surface.kind))
               : absl::StrCat("in the middle of this ", BearingKindName(check.surface.kind)),
           check.tipping_wanted),
       load.tipping_source});
}

void TellWhatIsJudged(HoldingReport& report) {
  report.judged = {
      absl::StrCat("toppling on a level floor, in ", report.standing.poses.size(),
                   report.standing.poses.size() == 1 ? " pose" : " poses"),
      absl::StrCat("tipping by a load downwards on ", report.surfaces.size(),
                   report.surfaces.size() == 1 ? " surface" : " surfaces", ", as drawn"),
      absl::StrCat("what joins the parts, in ", report.joints.size(), " joints")};
  report.not_judged = {
      "glue: where it is used is not known, and nothing is taken to be glued",
      "how strong screws, dowels and brackets are, and what it takes to pull them out",
      "whether a standard is met: loads and distances are as its are commonly cited, its tests are "
      "others",
      "pushes from the side, what it is fixed to, wheels that roll, floors that are not level"};
  std::size_t odd = 0;
  for (const Joint& joint : report.joints) {
    odd += static_cast<std::size_t>(
        std::count_if(joint.principals.begin(), joint.principals.end(),
                      [&](const auto& part) { return !part.is_box && !joint.fasteners.empty(); }));
  }
  if (odd > 0) {
    report.not_judged.push_back(absl::StrCat(
        "edge distances in parts that do not fill their boxes: ", odd, " times in these joints"));
  }
}

}  // namespace

absl::StatusOr<HoldingReport> CheckHolding(const Design& design,
                                           const std::vector<parametric::Item>& items,
                                           const std::vector<parametric::Material>& materials,
                                           const DesignOf& design_of) {
  HoldingReport report;
  report.standing = StandingInPoses(design, items, materials);
  report.worst_pose = WorstPose(report.standing);
  JudgeStanding(report.standing, report.findings);
  MORTISE_ASSIGN_OR_RETURN(const Redrawn redrawn, Redraw(design));
  const parametric::Assembly& drawn = redrawn.assembly;
  std::vector<BearingSurface> surfaces =
      FindBearingSurfaces(drawn, report.standing.poses.front().support.floor);
  std::stable_sort(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) {
    return a.box.maximum.z() < b.box.maximum.z();
  });
  for (BearingSurface& surface : surfaces) {
    report.surfaces.push_back(CheckSurface(std::move(surface), report.standing));
    JudgeSurface(report.surfaces.back(), report.findings);
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<CollectionConnection> connections,
                           ConnectionsOf(drawn.name, drawn));
  report.joints = JointsOf(drawn, connections, items, materials);
  for (auto judged : {JudgeWhole(PrincipalNames(drawn), report.joints),
                      JudgeMotion(drawn, report.joints, OfRedrawn(redrawn, design_of)),
                      FindLooseFasteners(drawn, items, materials), JudgeJoints(report.joints)}) {
    std::move(judged.begin(), judged.end(), std::back_inserter(report.findings));
  }
  report.findings = Ordered(std::move(report.findings));
  TellWhatIsJudged(report);
  return report;
}

}  // namespace mortise::composer
