// Big things in pieces: a blob or bytes as a stream of mortise.v1.Chunk, and back together.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/stream_writer.h"

namespace google::protobuf {
template <typename Element>
class RepeatedPtrField;
}
namespace mortise::v1 {
class Artifact;
class Chunk;
}  // namespace mortise::v1
namespace mortise::store {
class BlobFolder;
class BlobWriter;
}  // namespace mortise::store

namespace mortise::rpc {

inline constexpr int64_t kChunkBytes = 512 * 1024;

// What the receiver is told about the whole.
struct StreamedFile {
  std::string file_name;   // "table.step"
  std::string media_type;  // "model/step"
};

// Sends a blob and ends the stream; reads on only as the client does. NOT_FOUND ends it, too.
void StreamBlob(store::BlobFolder* blobs, const std::string& digest, const StreamedFile& file,
                const std::shared_ptr<StreamWriter<v1::Chunk>>& writer);

// Sends the blob of that of `owner`'s artifacts which is called `file_name`, as StreamBlob does.
// NOT_FOUND naming "owner/file_name" if it has none of this name.
absl::Status StreamArtifact(store::BlobFolder* blobs, const std::string& owner,
                            const google::protobuf::RepeatedPtrField<v1::Artifact>& artifacts,
                            const std::string& file_name,
                            const std::shared_ptr<StreamWriter<v1::Chunk>>& writer);

// As StreamBlob, for bytes at hand.
void StreamBytes(std::string bytes, const StreamedFile& file,
                 const std::shared_ptr<StreamWriter<v1::Chunk>>& writer);

// Puts received chunks into a blob, checking order, size and digest.
class ChunkAssembler {
 public:
  // At most `limit` bytes (RESOURCE_EXHAUSTED past it).
  ChunkAssembler(store::BlobFolder* blobs, int64_t limit);
  ~ChunkAssembler();

  // Fails with INVALID_ARGUMENT naming the field: a gap, a chunk over 1 MiB, or more than
  // total_size.
  absl::Status Append(const v1::Chunk& chunk);

  // Fails as Append would, and takes nothing.
  absl::Status Check(const v1::Chunk& chunk) const;

  // Returns the digest of the whole, when all of it has come; the blob is not in its place yet.
  // INVALID_ARGUMENT if bytes are missing or differ from `sha256`: nothing is kept then.
  absl::StatusOr<std::string> Digest() const;

  // Puts the blob into its place. Fails as Digest does, and as BlobWriter::Finish.
  absl::StatusOr<std::string> Finish();

 private:
  store::BlobFolder* blobs_;
  int64_t limit_;
  int64_t received_ = 0;
  int64_t total_size_ = 0;
  std::string sha256_;
  std::unique_ptr<store::BlobWriter> writer_;
};

}  // namespace mortise::rpc
