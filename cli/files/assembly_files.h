// Assemblies as files: what `mortise assembly import|export` take and give.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/session.h"
#include "mortise/v1/assembly.pb.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Adds import and export to `assembly`.
void AddAssemblyFileCommands(CLI::App& assembly, Session& session);

// Returns the parameters that `assembly adjust --json` printed, or a sample of `assembly sample
// --json`.
absl::StatusOr<std::vector<double>> ReadParameters(const std::filesystem::path& path);

// Writes a design as a file, and says so; nothing if there is no path.
absl::Status ExportTo(const v1::ExportAssemblyRequest& request, const std::filesystem::path& path,
                      const GatewayClient& client, const Output& output);

}  // namespace mortise::cli
