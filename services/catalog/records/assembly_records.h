// Assemblies in the store, each revision with the items and materials it was imported with, so that
// what a revision can be changed to never changes.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/author.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/records/catalog_records.h"

namespace mortise::catalog {

// Returns an assembly revision (0: the latest) and all it uses but shapes, which AddShapes adds.
// NOT_FOUND, or INVALID_ARGUMENT naming "name" or "revision".
absl::StatusOr<v1::AssemblyBundle> GetAssemblyBundle(store::ReadTransaction& transaction,
                                                     const std::string& name, int64_t revision);

// Latest revisions without parts, groups and joints, in the order of names; only those that meet
// all of the request's filters. INVALID_ARGUMENT naming page_size, page_token, item, text or fields
// of filter.
absl::StatusOr<Page<v1::Assembly>> ListAssemblies(store::ReadTransaction& transaction,
                                                  const v1::ListAssembliesRequest& request);

// Returns the assembly with those items, materials and shapes it names that exist, and its digest.
absl::StatusOr<v1::AssemblyBundle> Freeze(store::ReadTransaction& transaction,
                                          const v1::Assembly& message);

// Writes a bundle that can be parametrised, and its shapes, as the revision after
// `expected_revision` ("assembly.imported") and returns the assembly; the creator stays that of the
// revision before. If the present revision has the same content and tags, that is returned and
// nothing changes. ABORTED if the latest revision is not `expected_revision`.
absl::StatusOr<v1::Assembly> ImportBundle(store::Transaction& transaction,
                                          v1::AssemblyBundle bundle, int64_t expected_revision,
                                          const resources::Author& author);

// Removes an assembly ("assembly.deleted"); its revisions stay readable by number. ABORTED for
// another revision; FAILED_PRECONDITION, ASSEMBLY_IN_USE, naming templates whose latest revision
// exposes it.
absl::Status DeleteAssembly(store::Transaction& transaction,
                            const v1::DeleteAssemblyRequest& request,
                            const resources::Author& author);

}  // namespace mortise::catalog
