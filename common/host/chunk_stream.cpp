#include "common/host/chunk_stream.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/store/blob_folder.h"
#include "mortise/v1/types.pb.h"

namespace mortise::rpc {
namespace {

constexpr std::size_t kMaxChunk = 1024 * 1024;

using ChunkWriter = std::shared_ptr<StreamWriter<v1::Chunk>>;
using ReadRange = std::function<absl::StatusOr<std::string>(int64_t offset, int64_t length)>;

// Pulls the whole through `read`, piece by piece.
void StreamRanges(int64_t total_size, const std::string& sha256, const StreamedFile& file,
                  ReadRange read, const ChunkWriter& writer) {
  auto offset = std::make_shared<int64_t>(0);
  auto first = std::make_shared<bool>(true);
  std::weak_ptr<StreamWriter<v1::Chunk>> weak = writer;
  writer->Pull([=, read = std::move(read)]() -> absl::StatusOr<std::optional<v1::Chunk>> {
    if (*offset >= total_size && !*first) {
      if (const ChunkWriter alive = weak.lock()) alive->Finish(absl::OkStatus());
      return std::optional<v1::Chunk>();
    }
    v1::Chunk chunk;
    chunk.set_offset(*offset);
    MORTISE_ASSIGN_OR_RETURN(*chunk.mutable_data(),
                             read(*offset, std::min(kChunkBytes, total_size - *offset)));
    if (chunk.data().empty() && total_size > 0) {
      return absl::DataLossError("the file is shorter than it was");
    }
    if (*first) {
      chunk.set_total_size(total_size);
      chunk.set_sha256(sha256);
      chunk.set_file_name(file.file_name);
      chunk.set_media_type(file.media_type);
    }
    *first = false;
    *offset += static_cast<int64_t>(chunk.data().size());
    return std::optional<v1::Chunk>(std::move(chunk));
  });
}

}  // namespace

void StreamBlob(store::BlobFolder* blobs, const std::string& digest, const StreamedFile& file,
                const ChunkWriter& writer) {
  const absl::StatusOr<uint64_t> size = blobs->Size(digest);
  if (!size.ok()) {
    writer->Finish(size.status());
    return;
  }
  StreamRanges(
      static_cast<int64_t>(*size), digest, file,
      [blobs, digest](int64_t offset, int64_t length) {
        return blobs->GetRange(digest, static_cast<uint64_t>(offset),
                               static_cast<std::size_t>(length));
      },
      writer);
}

absl::Status StreamArtifact(store::BlobFolder* blobs, const std::string& owner,
                            const google::protobuf::RepeatedPtrField<v1::Artifact>& artifacts,
                            const std::string& file_name, const ChunkWriter& writer) {
  for (const v1::Artifact& artifact : artifacts) {
    if (artifact.file_name() != file_name) continue;
    StreamBlob(blobs, artifact.sha256(), {artifact.file_name(), artifact.media_type()}, writer);
    return absl::OkStatus();
  }
  return ResourceNotFound(absl::StrCat(owner, "/", file_name));
}

void StreamBytes(std::string bytes, const StreamedFile& file, const ChunkWriter& writer) {
  const auto size = static_cast<int64_t>(bytes.size());
  const std::string sha256 = Sha256Hex(bytes);
  StreamRanges(
      size, sha256, file,
      [bytes = std::move(bytes)](int64_t offset, int64_t length) -> absl::StatusOr<std::string> {
        return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
      },
      writer);
}

ChunkAssembler::ChunkAssembler(store::BlobFolder* blobs, int64_t limit)
    : blobs_(blobs), limit_(limit) {}

ChunkAssembler::~ChunkAssembler() = default;

absl::Status ChunkAssembler::Check(const v1::Chunk& chunk) const {
  if (chunk.offset() != received_) {
    return InvalidField("offset",
                        absl::StrCat("must be ", received_, ", the end of the last chunk"));
  }
  if (chunk.data().size() > kMaxChunk) {
    return InvalidField("data", "must be at most 1 MiB in each chunk");
  }
  if (!writer_ && chunk.total_size() < 0) {
    return InvalidField("total_size", "must not be negative");
  }
  const int64_t total_size = writer_ ? total_size_ : chunk.total_size();
  if (total_size > limit_) return TooLarge("total_size", absl::StrCat(limit_, " bytes"));
  if (received_ + static_cast<int64_t>(chunk.data().size()) > total_size) {
    return InvalidField("data", absl::StrCat("goes past the total_size of ", total_size));
  }
  return absl::OkStatus();
}

absl::Status ChunkAssembler::Append(const v1::Chunk& chunk) {
  MORTISE_RETURN_IF_ERROR(Check(chunk));
  if (!writer_) {
    total_size_ = chunk.total_size();
    sha256_ = chunk.sha256();
    MORTISE_ASSIGN_OR_RETURN(writer_, blobs_->Write());
  }
  MORTISE_RETURN_IF_ERROR(writer_->Append(chunk.data()));
  received_ += static_cast<int64_t>(chunk.data().size());
  return absl::OkStatus();
}

absl::StatusOr<std::string> ChunkAssembler::Digest() const {
  if (!writer_) return InvalidField("data", "no chunk was sent");
  if (received_ != total_size_) {
    return InvalidField("total_size",
                        absl::StrCat("is ", total_size_, ", but ", received_, " bytes came"));
  }
  std::string digest = writer_->Digest();
  if (!sha256_.empty() && digest != sha256_) {
    return InvalidField("sha256", "differs from the digest of what arrived");
  }
  return digest;
}

absl::StatusOr<std::string> ChunkAssembler::Finish() {
  MORTISE_RETURN_IF_ERROR(Digest().status());
  MORTISE_ASSIGN_OR_RETURN(std::string digest, writer_->Finish());
  writer_.reset();
  return digest;
}

}  // namespace mortise::rpc
