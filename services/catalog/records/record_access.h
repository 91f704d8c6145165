// What all kinds of the catalog's records have in common: names, pages, revisions, events.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/author.h"
#include "common/store/store.h"

namespace mortise::catalog {

// Kinds of records; also the collections of resource names.
inline constexpr const char* kMaterials = "materials";
inline constexpr const char* kItems = "items";
inline constexpr const char* kTemplates = "templates";
inline constexpr const char* kAssemblies = "assemblies";

// Returns what stands for a resource that was deleted, where its revisions can still be read: a
// revision after them that says nothing.
inline bool IsDeleted(const store::Record& record) { return record.payload.empty(); }

// Returns the record of the resource `kind/{id}` (revision 0: the present one). INVALID_ARGUMENT
// naming "name" or "revision"; NOT_FOUND naming the resource, also where it is deleted.
absl::StatusOr<store::Record> GetRecord(store::ReadTransaction& transaction, const char* kind,
                                        const std::string& name, int64_t revision = 0);

// The same; a record of revision 0 where there is none. Fields of failures are under `field`.
absl::StatusOr<store::Record> GetRecordOrNone(store::ReadTransaction& transaction, const char* kind,
                                              const std::string& name, const std::string& field);

// Writes a record that must not exist yet. ALREADY_EXISTS naming it.
absl::StatusOr<int64_t> PutNew(store::Transaction& transaction, const char* kind,
                               const std::string& name, const std::string& payload);

// What is wrong with a request, and "expected_revision" with it if that is one that no resource
// ever has; or, where other things are wrong too, not the latest of the resource. (By itself that
// is no fault of the request: see PutNext.)
absl::Status WithRevisionFault(store::Store& store, const char* kind, const std::string& name,
                               int64_t expected, const absl::Status& faults);

// Writes the revision after `present`, which is kept; 0 if the resource does not exist, or is
// deleted: then the revision after that. ABORTED, STALE_REVISION if that is not the latest.
absl::StatusOr<int64_t> PutNext(store::Transaction& transaction, const char* kind,
                                const std::string& name, const std::string& payload,
                                int64_t present);

// Deletes a resource, and keeps its revisions for those who ask for them by number. NOT_FOUND;
// ABORTED, STALE_REVISION if `revision` is not the latest.
absl::Status MarkDeleted(store::Transaction& transaction, const char* kind, const std::string& name,
                         int64_t revision);

// Tells what happened, and of which request; `data` is a JSON object.
absl::Status AppendEvent(store::Transaction& transaction, const std::string& type,
                         const std::string& subject, const nlohmann::json& data,
                         const resources::Author& author);

}  // namespace mortise::catalog
