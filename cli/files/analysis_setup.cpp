#include "cli/files/analysis_setup.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "cli/client/json_input.h"
#include "cli/client/requests.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/messages/proto_text.h"

namespace mortise::cli {
namespace {

constexpr char kSupport[] = "--support";
constexpr char kLoad[] = "--load";
constexpr char kSetup[] = "--setup";
constexpr char kConditions[] = "setup.boundary_conditions";

// A force in newtons, each coordinate with a unit of its own if it has one: "0, 0, -0.1kN".
absl::StatusOr<v1::Vector3> ParseForce(const std::string& text, const std::string& field) {
  const std::vector<std::string> pieces = absl::StrSplit(text, ',');
  if (pieces.size() != 3) {
    return InvalidField(field, absl::StrCat("'", text, "' is not of the form X,Y,Z, in newtons"));
  }
  double coordinates[3] = {};
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckUnit(pieces[i], "N", field));
    MORTISE_ASSIGN_OR_RETURN(coordinates[i], ParseMetricValue(pieces[i], field));
  }
  v1::Vector3 force;
  force.set_x(coordinates[0]);
  force.set_y(coordinates[1]);
  force.set_z(coordinates[2]);
  return force;
}

absl::Status ReadSetup(const std::filesystem::path& file, v1::AnalysisSetup& setup) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, parametric::kMaxTextBytes));
  return LowerCaseExtension(file) == ".json"
             ? ReadJson(text, file.string(), setup)
             : parametric::ParseProtoText(text, file.string(), setup);
}

}  // namespace

void AddSetupFlags(CommandFlags& flags, SetupFlags& options) {
  flags
      .Add(kSupport, options.supports,
           "A face that is held besides, such as \"leg 1/z_min\", or z_min of what is one part; "
           "again for more")
      ->allow_extra_args(false);
  flags
      .Add(kLoad, options.loads,
           "A force on a face besides, FACE=X,Y,Z in newtons, such as seat/z_max=0,0,-800; again "
           "for more")
      ->allow_extra_args(false);
  flags.Add(kSetup, options.file,
            "File of a mortise.v1.AnalysisSetup (.textproto, .json): supports, loads and heat of "
            "every kind besides");
}

absl::StatusOr<v1::AnalysisSetup> SetupOf(const SetupFlags& flags, FieldSources& sources) {
  v1::AnalysisSetup setup;
  if (!flags.file.empty()) {
    MORTISE_RETURN_IF_ERROR(ReadSetup(flags.file, setup));
    sources.AddFile("setup", flags.file.string());
  }
  sources.AddEach(kConditions, kSupport, flags.supports, setup.boundary_conditions_size());
  for (const std::string& face : flags.supports) {
    v1::EvaluatedBoundaryCondition& support = *setup.add_boundary_conditions();
    support.set_kind(v1::BoundaryCondition::FIXED);
    support.set_face(face);
  }
  sources.AddEach(kConditions, kLoad, flags.loads, setup.boundary_conditions_size());
  for (const std::string& text : flags.loads) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
      return InvalidField(kLoad, absl::StrCat("'", text, "' is not of the form FACE=X,Y,Z"));
    }
    v1::EvaluatedBoundaryCondition& load = *setup.add_boundary_conditions();
    load.set_kind(v1::BoundaryCondition::FORCE);
    load.set_face(text.substr(0, equals));
    const std::string field = absl::StrCat(kLoad, " ", load.face());
    MORTISE_ASSIGN_OR_RETURN(*load.mutable_force(), ParseForce(text.substr(equals + 1), field));
  }
  return setup;
}

}  // namespace mortise::cli
