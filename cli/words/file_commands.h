// Says which command takes a file, to somebody who gave it to another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace mortise::cli {

// What a file is, by its name and, of texts, by its first lines.
struct FileUse {
  std::string kind;                   // "a drawing (STEP)"
  std::vector<std::string> commands;  // that take one: "assembly import"; in the order to offer
};

// Returns how a file is used; without commands where it is nothing that a command takes.
FileUse UseOf(const std::filesystem::path& file);

// Returns the failure of `command` ("catalog import"), given its arguments that are no options,
// with "chair.obj: is a mesh; what takes it is: mortise assembly import chair.obj" where one of
// them is a file that this command does not take. What else is wrong with that file is left out.
// Only what was refused, or not found, is looked at; every other status is returned as it is.
absl::Status WithRightCommand(const absl::Status& failure, const std::string& command,
                              const std::vector<std::string>& arguments);

}  // namespace mortise::cli
