// Lists of one kind of resource, by the filters that all of them have.
#pragma once

#include <string>

#include "cli/client/session.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Makes `list` a command that lists the resources of `kind` ("workOrders"); where that is empty,
// of the kind that its first argument names.
void AddListOf(CLI::App& list, const std::string& kind, Session& session);

}  // namespace mortise::cli
