// Random scripts of what a person can do to a working model: pieces of all designs that ship are
// added, snapped, connected, moved, dragged and removed, and steps undone and redone. After each
// step the model is held against what must be true of every model.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/services/composer/scripts/shipped_origins.h"

namespace mortise::composer {

struct RandomScriptOptions {
  std::uint64_t seed = 1;
  int steps = 16;
  std::size_t most_parts = 250;  // of a model; larger pieces are not added
};

struct ScriptOutcome {
  std::vector<std::string> steps;         // for people, with what came of each
  std::map<std::string, int> done;        // how often by command
  std::map<std::string, int> refused;     // how often by command and reason
  std::map<std::string, double> seconds;  // by command
  std::vector<std::string> violations;    // what was not true; empty if nothing
  std::optional<ComposedBody> body;       // of the model at the end
  std::size_t parts = 0;                  // of it
  int made_connections = 0;               // with connecting parts
  int left_unheld = 0;                    // parts that removing others left in no connection
};

// Runs one, the same for the same options. Held true of the model after each step:
// - All relationships of body and loose components hold to 1e-6 m.
// - Nothing has penetrated by more than 0.1 mm, in any rest pose, that did not as drawn; when a
//   component is connected, no part of it reaches into the body, unless a connection holds the two,
//   and no new connecting part into anything but what it connects.
// - Every principal element is in a connection, or named by a warning, or was in none in the design
//   that it comes from, or is one that removing another left alone.
// - What is undone and done again gives the same state to the last bit.
// - What is refused is refused with a reason, and as a fault of the request.
ScriptOutcome RunRandomScript(const RandomScriptOptions& options);

}  // namespace mortise::composer
