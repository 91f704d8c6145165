// mortise-catalog: the catalog as a process.
#include <CLI/CLI.hpp>
#include <filesystem>

#include "common/rpc/run_service.h"
#include "services/catalog/catalog_service.h"

int main(int argc, char** argv) {
  std::filesystem::path collection;
  mortise::rpc::ServiceDescription description;
  description.name = "catalog";
  description.title = "Keeps materials, items and templates, and evaluates designs";
  description.add_flags = [&collection](CLI::App& app) {
    app.add_option("--collection", collection,
                   "Folder to fill an empty catalog from (collection/ in the repository)")
        ->envname("MORTISE_COLLECTION");
  };
  return mortise::rpc::RunService(argc, argv, description,
                                  [&collection](mortise::rpc::ServiceEnvironment& environment) {
                                    return mortise::catalog::MakeServices(environment, collection);
                                  });
}
