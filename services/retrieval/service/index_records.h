// Indexes and the covers they are made of, in the store; their primitives lie in the blob folder.
//
// A cover is an index of one template. It is stored as soon as it is made, so that building an
// index goes on where it was stopped.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::retrieval {

inline const resources::Collection<v1::ShapeIndex> kIndexes{
    .names = "indexes", .kind = "indexes", .event = "index", .newest_first = false};

// The `format_version` of what is written now.
inline constexpr int kIndexFormat = 2;

// "d2", "voxel", "light-field"; the id of the descriptor's index. D2 where it is unspecified.
std::string IndexIdOf(v1::ShapeDescriptor descriptor);

// Returns every descriptor there is, in a fixed order.
std::vector<v1::ShapeDescriptor> AllShapeDescriptors();

// Whether an index or a cover says what this version of the service says, and by a descriptor that
// computes what this one does.
bool IsOfThisVersion(const v1::ShapeIndex& record, const Descriptor& descriptor);

// Returns the cover of a family as this version writes it, without a file yet.
v1::ShapeIndex EmptyCover(v1::ShapeDescriptor kind, double delta, const Descriptor& descriptor,
                          const v1::ShapeIndex::Family& family);

// Returns the cover of a template, or of a group of its assembly, by an index's id, if there is
// one. STORAGE_FAILED for a damaged record.
absl::StatusOr<std::optional<v1::ShapeIndex>> FindCover(store::ReadTransaction& transaction,
                                                        const std::string& index,
                                                        const std::string& template_name,
                                                        const std::string& group);

// Returns the covers of an index, by name of their templates, the whole before its groups.
absl::StatusOr<std::vector<v1::ShapeIndex>> ListCovers(store::ReadTransaction& transaction,
                                                       const std::string& index);

// Returns those of the groups of one template alone.
absl::StatusOr<std::vector<v1::ShapeIndex>> ListGroupCovers(store::ReadTransaction& transaction,
                                                            const std::string& index,
                                                            const std::string& template_name);

// Writes a cover, in place of that which the template or group had.
absl::Status PutCover(store::Transaction& transaction, const std::string& index,
                      const v1::ShapeIndex& cover);

absl::Status DeleteCover(store::Transaction& transaction, const std::string& index,
                         const std::string& template_name, const std::string& group);

// Forgets an index and its covers, and tells of it ("index.deleted"). NOT_FOUND.
absl::Status ForgetIndex(store::Transaction& transaction, const std::string& name,
                         const std::string& trace_id);

// Writes an index and tells of it ("index.updated").
absl::Status PutIndex(store::Transaction& transaction, const v1::ShapeIndex& index,
                      const std::string& trace_id);

// Stores a file; its digest. One that was damaged since it was stored is written again.
absl::StatusOr<std::string> StoreCoverFile(store::BlobFolder& blobs, std::string_view bytes);

// Returns the primitives of a cover, as family 0. Fails as ReadIndex; DATA_LOSS where the file has
// others than it says, or is not of one family.
absl::StatusOr<FamilyCover> ReadCover(store::BlobFolder& blobs, const std::string& sha256,
                                      const Descriptor& descriptor);

// Says of a family what its primitives are: points, tangents, structures.
void CountPrimitives(const FamilyCover& cover, v1::ShapeIndex::Family* family);

}  // namespace mortise::retrieval
