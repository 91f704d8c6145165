// Removing what is in the catalog.
#pragma once

#include "cli/client/session.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Adds `delete` to `mortise catalog`: a template, item or material.
void AddCatalogDelete(CLI::App& catalog, Session& session);

// Adds `delete` to `mortise assembly`.
void AddAssemblyDelete(CLI::App& assembly, Session& session);

}  // namespace mortise::cli
