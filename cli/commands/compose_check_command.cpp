#include "cli/commands/compose_check_command.h"

#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/commands/compose_calls.h"
#include "common/base/files.h"

namespace mortise::cli {
namespace {

constexpr int kPictureWidth = 1000;  // pixels
constexpr int kMaxNames = 4;         // of parts in one line

struct CheckOptions {
  std::string model;
  std::filesystem::path picture;
};

// "side 1, side 2 and 5 others".
template <typename Names>
std::string NamesText(const Names& names) {
  std::vector<std::string> shown;
  for (const std::string& name : names) {
    if (static_cast<int>(shown.size()) < kMaxNames) shown.push_back(name);
  }
  std::string text = absl::StrJoin(shown, ", ");
  const int left = static_cast<int>(names.size()) - kMaxNames;
  if (left > 0) absl::StrAppend(&text, " and ", left, left == 1 ? " other" : " others");
  return text;
}

std::string PoseName(const v1::PoseStanding& pose) {
  return pose.pose().empty() ? "as drawn" : pose.pose();
}

void PrintStanding(const v1::ModelCheck& check, const Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::PoseStanding& pose : check.poses()) {
    rows.push_back({PoseName(pose), Millimetres(pose.margin()),
                    absl::StrFormat("%.1f degrees", pose.angle() * 180 / std::numbers::pi),
                    pose.falls()});
  }
  output.Table({"pose", "margin", "tilt", "falls"}, rows);
  if (check.poses_size() > 1) {
    output.Line(absl::StrCat("worst: ", PoseName(check.poses(check.worst_pose()))));
  }
}

void PrintSurfaces(const v1::ModelCheck& check, const Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::BearingSurface& surface : check.surfaces()) {
    rows.push_back(
        {surface.kind(), NamesText(surface.parts()), surface.because(),
         Millimetres(surface.maximum().z()), absl::StrFormat("%.0f N", surface.load()),
         surface.has_tipping_force() ? absl::StrFormat("%.0f N", surface.tipping_force()) : "never",
         absl::StrFormat("%.0f N", surface.tipping_wanted())});
  }
  output.Table({"bears", "parts", "so named", "height", "load", "tips at", "wanted"}, rows);
}

void PrintFindings(const v1::ModelCheck& check, const Output& output) {
  int fastened = 0;
  for (const v1::ModelJoint& joint : check.joints()) fastened += joint.fasteners_size() > 0 ? 1 : 0;
  output.Line(absl::StrCat(check.joints_size(), " joints, ", fastened, " of them with fasteners"));
  for (const v1::CheckFinding& finding : check.findings()) {
    output.Line(absl::StrCat(
        absl::AsciiStrToLower(v1::CheckFinding::Severity_Name(finding.severity())), ": ",
        finding.parts().empty() ? "" : absl::StrCat(NamesText(finding.parts()), ": "),
        finding.text(), " (", finding.rule(), "; ", finding.source(), ")"));
  }
  if (check.findings().empty()) output.Line("nothing is found to be wrong");
}

absl::Status Check(const CheckOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::CheckModelRequest request;
  request.set_name(ResourceName("models", options.model));
  if (!options.picture.empty()) request.set_width(kPictureWidth);
  MORTISE_ASSIGN_OR_RETURN(v1::ModelCheck check,
                           AskComposer(*client, &v1::ComposerService::Stub::CheckModel, request));
  output.Line(
      absl::StrFormat("%s, revision %d: %.3g kg", request.name(), check.revision(), check.mass()));
  PrintStanding(check, output);
  PrintSurfaces(check, output);
  PrintFindings(check, output);
  for (const std::string& each : check.judged()) output.Line(absl::StrCat("judged: ", each));
  for (const std::string& each : check.not_judged()) {
    output.Line(absl::StrCat("not judged: ", each));
  }
  if (!options.picture.empty()) {
    MORTISE_RETURN_IF_ERROR(WriteFile(options.picture, check.png()));
    output.Line(absl::StrCat("  ", options.picture.string()));
    check.clear_png();
  }
  output.DocumentOf(check);
  return absl::OkStatus();
}

}  // namespace

void AddComposeCheckCommand(CLI::App& compose, Session& session) {
  auto options = std::make_shared<CheckOptions>();
  CommandFlags check(*compose.add_subcommand("check", "Will a model stand and hold?"));
  check.Add("model", options->model, "Model, such as desk", "name")->required();
  check.Add("--picture", options->picture,
            "PNG file for a picture: what is at fault red, what is warned of orange");
  check.command().footer("Example: mortise compose check desk");
  check.Run(session, [options](Session& s, Output& o) { return Check(*options, s, o); });
}

}  // namespace mortise::cli
