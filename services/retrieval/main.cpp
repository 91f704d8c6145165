// mortise-retrieval: the service that finds templates by shape.
#include <string_view>

#include "common/host/run_service.h"
#include "common/mesh/scenes/scene_reader.h"
#include "services/retrieval/service/retrieval_service.h"

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::mesh::kSceneChildArgument) {
    return mortise::mesh::RunSceneChild();
  }
  return mortise::rpc::RunService(
      argc, argv,
      {.name = "retrieval", .title = "Finds the templates that can become a given shape."},
      mortise::retrieval::MakeServices);
}
