// mortise-composer: the service that composes new designs of pieces of others.
#include "common/host/run_service.h"
#include "services/composer/service/composer_service.h"

int main(int argc, char** argv) {
  return mortise::rpc::RunService(
      argc, argv,
      {.name = "composer", .title = "Composes designs that can be built of pieces of others."},
      mortise::composer::MakeServices);
}
