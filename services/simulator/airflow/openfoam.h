// Runs the programs of OpenFOAM, which are installed beside ours and not linked (Debian's package
// openfoam, version 1912).
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/fem/linear/stage_progress.h"

namespace mortise::simulator {

// The reasons of failures where OpenFOAM is not installed, and where it gave up.
inline constexpr char kNoOpenFoam[] = "NO_OPENFOAM";
inline constexpr char kOpenFoamFailed[] = "OPENFOAM_FAILED";

struct OpenFoamRun {
  std::filesystem::path case_folder;  // with constant/ and system/
  std::stop_token stop = {};          // ends the program, as CANCELLED
  StageProgress* progress = nullptr;  // told of iterations, if it is there
};

// Fails with FAILED_PRECONDITION, NO_OPENFOAM, naming the package, where `program` is not to be
// found on PATH.
absl::Status CheckOpenFoam(const std::string& program);

// Runs `program` on the case until it ends; what it says goes to "log.PROGRAM" in the case's
// folder. INTERNAL, OPENFOAM_FAILED, with OpenFOAM's own words if it fails; else as CheckOpenFoam.
absl::Status RunOpenFoam(const std::string& program, const std::vector<std::string>& arguments,
                         const OpenFoamRun& run);

}  // namespace mortise::simulator
