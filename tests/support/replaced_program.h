// Another program in the place of one that is called by its name.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/environment.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

// For the time of a test PATH leads to this program alone, a shell script; to none at all if the
// script is empty.
class ReplacedProgram {
 public:
  ReplacedProgram(const std::string& name, const std::string& script)
      : path_("PATH", folder_.path()) {
    if (script.empty()) return;
    const std::filesystem::path program = folder_.path() / name;
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  }

 private:
  const TemporaryFolder folder_;
  const Environment path_;
};

}  // namespace mortise::testing
