#include "cli/client/command_flags.h"

#include <utility>

namespace mortise::cli {

FieldSources CommandFlags::Sources() const {
  FieldSources sources;
  for (const Given& given : given_) {
    if (given.field.empty()) continue;
    if (given.texts != nullptr) {
      sources.AddEach(given.field, given.flag, *given.texts);
    } else {
      sources.Add(given.field, given.flag);
    }
  }
  return sources;
}

void CommandFlags::Run(Session& session, std::function<absl::Status(Session&, Output&)> run) const {
  Run(session,
      [run = std::move(run)](FieldSources&, Session& s, Output& output) { return run(s, output); });
}

void CommandFlags::Run(
    Session& session,
    std::function<absl::Status(FieldSources& sources, Session&, Output&)> run) const {
  command_->callback([&session, flags = *this, run = std::move(run)] {
    session.command = [flags, run](Session& s, Output& output) {
      FieldSources sources = flags.Sources();
      const absl::Status status = run(sources, s, output);
      return sources.Name(status);
    };
  });
}

}  // namespace mortise::cli
