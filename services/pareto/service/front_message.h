// What a discovery found, as a message.
#pragma once

#include "services/pareto/discovery/ask_tell.h"
#include "services/pareto/service/discovery_problem.h"

namespace mortise::v1 {
class Front;
}

namespace mortise::pareto {

// Without name, specification and time.
v1::Front MakeFront(const DiscoveryProblem& problem, const AskTell& discovery);

}  // namespace mortise::pareto
