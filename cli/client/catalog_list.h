// What is in the catalog, all of it or what filters leave.
#pragma once

#include "cli/client/session.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Adds `list` to `mortise catalog`.
void AddCatalogList(CLI::App& catalog, Session& session);

}  // namespace mortise::cli
