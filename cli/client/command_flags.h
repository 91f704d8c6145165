// Declares the flags and arguments of a command, each once, with the field of the request that it
// gives. CLI11 reads the declaration for parsing, help and completion; faults that a service finds
// in a field name the flag.
//
//   auto options = std::make_shared<PlanOptions>();
//   CommandFlags flags(*app.add_subcommand("plan", "Plan the fabrication of a design"));
//   flags.Add("--kerf", options->kerf, "Width of a saw cut", "rules.kerf");
//   flags.Run(session, [options](Session& s, Output& o) { return Plan(*options, s, o); });
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "absl/status/status.h"
#include "cli/client/field_sources.h"
#include "cli/client/output.h"
#include "cli/client/session.h"

namespace mortise::cli {

class CommandFlags {
 public:
  // `command` must outlive the declaration.
  explicit CommandFlags(CLI::App& command) : command_(&command) {}

  CLI::App& command() { return *command_; }

  // Declares a flag ("--kerf") or an argument ("template") with its help; it is parsed into
  // `value`, which must be there when the command runs. `field` is the field of the request that it
  // gives ("rules.kerf"), or empty. The texts of a flag that may be repeated give the elements of
  // the field, and are of the form NAME=VALUE or NAME.
  template <typename T>
  CLI::Option* Add(const std::string& flag, T& value, const std::string& help,
                   const std::string& field = "") {
    if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      given_.push_back({field, flag, &value});
    } else {
      given_.push_back({field, flag});
    }
    return command_->add_option(flag, value, help);
  }

  // Says that a flag gives a field besides, as a whole.
  void AlsoGives(const std::string& flag, const std::string& field) {
    given_.push_back({field, flag});
  }

  // Returns which flag gives which field, as the command line was parsed.
  FieldSources Sources() const;

  // Makes the command call `run` once the command line has been parsed. Failures of `run` that name
  // fields then name the flags.
  void Run(Session& session, std::function<absl::Status(Session&, Output&)> run) const;

  // The same for a command whose flags do not tell all by themselves: `run` adds to `sources` what
  // gives the other fields.
  void Run(Session& session,
           std::function<absl::Status(FieldSources& sources, Session&, Output&)> run) const;

 private:
  struct Given {
    std::string field;
    std::string flag;
    const std::vector<std::string>* texts = nullptr;  // of a flag that may be repeated
  };

  CLI::App* command_;
  std::vector<Given> given_;
};

}  // namespace mortise::cli
