// mortise-interpolator: maps of design spaces as a service.
#include "common/host/run_service.h"
#include "services/interpolator/service/interpolator_service.h"

int main(int argc, char** argv) {
  return mortise::rpc::RunService(
      argc, argv,
      {.name = "interpolator",
       .title = "Samples design spaces ahead of time and interpolates what is known of them",
       .add_flags = {}},
      mortise::interpolator::MakeServices);
}
