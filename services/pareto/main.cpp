// mortise-pareto: discovery and exploration of Pareto fronts as a service.
#include "common/host/run_service.h"
#include "services/pareto/service/pareto_service.h"

int main(int argc, char** argv) {
  return mortise::rpc::RunService(
      argc, argv,
      {.name = "pareto",
       .title = "Discovers Pareto fronts and lets people move along them",
       .add_flags = {}},
      mortise::pareto::MakeServices);
}
