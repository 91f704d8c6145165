// How a design is held and loaded for one analysis, as flags and files give it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/client/command_flags.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::cli {

struct SetupFlags {
  std::vector<std::string> supports;  // "leg 1/z_min", faces that are held
  std::vector<std::string> loads;     // "seat/z_max=0,0,-100N", forces on faces
  std::filesystem::path file;         // a mortise.v1.AnalysisSetup

  bool empty() const { return supports.empty() && loads.empty() && file.empty(); }
};

// Declares --support, --load and --setup.
void AddSetupFlags(CommandFlags& flags, SetupFlags& options);

// Returns the conditions of the file, then supports, then loads, and adds to `sources` what gives
// each of them. INVALID_ARGUMENT naming the flag, or the file with the place in it.
absl::StatusOr<v1::AnalysisSetup> SetupOf(const SetupFlags& flags, FieldSources& sources);

}  // namespace mortise::cli
