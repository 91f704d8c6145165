#include "services/composer/service/check_methods.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/design/template_validation.h"
#include "common/messages/vector_codec.h"
#include "services/composer/holding/holding_report.h"
#include "services/composer/service/bundle_contents.h"
#include "services/composer/service/model_picture.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer::methods {
namespace {

constexpr int kMinPixels = 16;
constexpr int kMaxPixels = 4096;

v1::PoseStanding ToProto(const PoseStanding& pose) {
  v1::PoseStanding message;
  message.set_pose(pose.pose);
  message.set_margin(pose.standing.margin);
  message.set_angle(pose.standing.angle);
  message.set_falls(DirectionName(pose.standing.falls_towards));
  *message.mutable_center_of_mass() = VectorToProto(pose.center_of_mass);
  return message;
}

v1::BearingSurface ToProto(const SurfaceCheck& check) {
  const BearingSurface& surface = check.surface;
  const BearingLoad& load = LoadOf(surface.kind);
  v1::BearingSurface message;
  message.set_kind(BearingKindName(surface.kind));
  message.mutable_parts()->Assign(surface.parts.begin(), surface.parts.end());
  message.set_because(surface.because);
  *message.mutable_minimum() = VectorToProto(surface.box.minimum);
  *message.mutable_maximum() = VectorToProto(surface.box.maximum);
  message.set_load(surface.Load());
  message.set_load_source(load.source);
  if (std::isfinite(check.tipping_force)) message.set_tipping_force(check.tipping_force);
  message.set_tipping_wanted(check.tipping_wanted);
  message.set_tipping_source(load.tipping_source);
  *message.mutable_tipping_at() = VectorToProto(
      Eigen::Vector3d(check.tipping_at.x(), check.tipping_at.y(), surface.box.maximum.z()));
  return message;
}

v1::ModelJoint ToProto(const Joint& joint) {
  v1::ModelJoint message;
  for (const JoinedPart& part : joint.principals) message.add_principals(part.name);
  std::map<std::string, int> counts;
  for (const Fastener& fastener : joint.fasteners) ++counts[fastener.item];
  for (const auto& [item, count] : counts) {
    v1::FastenerCount* const added = message.add_fasteners();
    added->set_item(item);
    added->set_count(count);
  }
  message.set_length(joint.length);
  message.set_moves(joint.moves);
  return message;
}

v1::CheckFinding ToProto(const Finding& finding) {
  v1::CheckFinding message;
  message.set_severity(
      static_cast<v1::CheckFinding::Severity>(static_cast<int>(finding.severity) + 1));
  message.set_rule(finding.rule);
  message.mutable_parts()->Assign(finding.parts.begin(), finding.parts.end());
  message.set_found(finding.found);
  message.set_wanted(finding.wanted);
  message.set_unit(finding.unit);
  message.set_text(finding.text);
  message.set_source(finding.source);
  return message;
}

v1::ModelCheck ToProto(const HoldingReport& report) {
  v1::ModelCheck message;
  message.set_mass(report.standing.mass);
  for (const PoseStanding& pose : report.standing.poses) *message.add_poses() = ToProto(pose);
  message.set_worst_pose(static_cast<int>(report.worst_pose));
  for (const SurfaceCheck& surface : report.surfaces) *message.add_surfaces() = ToProto(surface);
  for (const Joint& joint : report.joints) *message.add_joints() = ToProto(joint);
  for (const Finding& finding : report.findings) *message.add_findings() = ToProto(finding);
  message.mutable_judged()->Assign(report.judged.begin(), report.judged.end());
  message.mutable_not_judged()->Assign(report.not_judged.begin(), report.not_judged.end());
  return message;
}

absl::Status CheckPixels(const v1::CheckModelRequest& asked) {
  std::vector<FieldViolation> findings;
  const auto check = [&](const char* field, int pixels) {
    if (pixels == 0 || (pixels >= kMinPixels && pixels <= kMaxPixels)) return;
    findings.push_back(
        {field, absl::StrCat("must be ", kMinPixels, " to ", kMaxPixels, " pixels")});
  };
  check("width", asked.width());
  check("height", asked.height());
  return parametric::ToStatus(findings);
}

// The parts that findings are about, each in the colour of the worst.
std::map<std::string, render::Color> MarksOf(const std::vector<Finding>& findings) {
  constexpr render::Color kColors[] = {{0.95, 0.85, 0.2}, {0.95, 0.5, 0.1}, {0.85, 0.1, 0.1}};
  std::map<std::string, render::Color> marks;
  for (const Finding& finding : findings) {
    for (const std::string& part : finding.parts) {
      marks.emplace(part, kColors[static_cast<std::size_t>(finding.severity)]);
    }
  }
  return marks;
}

}  // namespace

absl::StatusOr<v1::ModelCheck> CheckModel(const Composer& composer, const rpc::Call& call,
                                          const v1::CheckModelRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CheckPixels(asked));
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, ReadModel(*composer.store, asked.name()));
  MORTISE_ASSIGN_OR_RETURN(const OpenModel model,
                           Open(stored, composer.drawings, [&call] { return call.cancelled(); }));
  if (!model.body) {
    return PreconditionFailed("MODEL_EMPTY", absl::StrCat("nothing is in ", model.name, " yet"),
                              "name");
  }
  MORTISE_ASSIGN_OR_RETURN(const auto drawing,
                           composer.drawings.Get(model.name, model.body->drawing));
  MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing->bundle));
  MORTISE_ASSIGN_OR_RETURN(
      HoldingReport report,
      CheckHolding(model.body->design, contents.items, contents.materials, DesignsIn(model)));
  for (const OpenLoose& loose : model.loose) {
    report.not_judged.push_back(absl::StrCat("'", loose.id, "', which is not connected"));
  }
  v1::ModelCheck message = ToProto(report);
  message.set_revision(stored.head.revision());
  if (asked.width() > 0) {
    const int height = asked.height() > 0 ? asked.height() : asked.width() * 3 / 4;
    MORTISE_ASSIGN_OR_RETURN(*message.mutable_png(),
                             DrawMarkedParts(model, composer.drawings, MarksOf(report.findings),
                                             asked.width(), std::max(height, kMinPixels)));
  }
  return message;
}

}  // namespace mortise::composer::methods
