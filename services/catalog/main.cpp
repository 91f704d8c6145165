// mortise-catalog: the catalog as a process.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <string_view>

#include "common/cad/step/step_isolation.h"
#include "common/host/run_service.h"
#include "common/mesh/scenes/scene_reader.h"
#include "services/catalog/service/catalog_service.h"

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::cad::kStepChildArgument) {
    return mortise::cad::RunStepChild();
  }
  if (argc == 2 && std::string_view(argv[1]) == mortise::mesh::kSceneChildArgument) {
    return mortise::mesh::RunSceneChild();
  }
  std::filesystem::path collection;
  mortise::rpc::ServiceDescription description;
  description.name = "catalog";
  description.title = "Keeps materials, items and templates, and evaluates designs";
  description.add_flags = [&collection](CLI::App& app) {
    app.add_option(
           "--collection", collection,
           "Folder whose items, templates and assemblies the catalog takes where it lacks them "
           "(collection/ in the repository)")
        ->envname("MORTISE_COLLECTION");
  };
  return mortise::rpc::RunService(argc, argv, description,
                                  [&collection](mortise::rpc::ServiceEnvironment& environment) {
                                    return mortise::catalog::MakeServices(environment, collection);
                                  });
}
