// mortise catalog import: files of materials, items and templates into the catalog.
#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/status.h"
#include "cli/client/output.h"
#include "cli/client/session.h"

namespace mortise::cli {

// Reads design files, checks all of them against each other and the catalog, and has the catalog
// store them in one transaction. What it has already with the same content stays as it is; what
// differs becomes a new revision. By its extension, a file is
//   .csv         items or materials, a row each (docs/catalogue.md has the columns),
//   .json        a TemplateBundle, or a list of items as `catalog list items --json` prints it,
//   any other    protobuf text: a TemplateBundle, or a Template where a line says
//                "# proto-message: mortise.v1.Template".
//
// Where the shape of an item is a path, beside its file, that file (STEP, or STL in millimetres) is
// added to the catalog first.
//
// INVALID_ARGUMENT naming every fault of every file with its line, and column in CSV, with nothing
// stored: text that cannot be parsed, content that cannot be built, a name that is there twice.
// RESOURCE_EXHAUSTED for more than fits into one call, 4 MB.
absl::Status ImportFiles(const std::vector<std::filesystem::path>& files, Session& session,
                         Output& output);

}  // namespace mortise::cli
