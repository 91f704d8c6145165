// Files that are too large for a message and are uploaded before the request that they belong to:
// bytes in the blob folder, and a record that says since when.
//
// The record comes first and goes last. It is committed before its blob is put into place, so that
// no crash leaves a blob that nobody knows of; and the blob is removed while the record's deletion
// has it locked, so that none vanishes under a record that was written meanwhile. A record whose
// blob never came counts as a file that has not been uploaded, and is forgotten like any other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/chunk_stream.h"
#include "common/rpc/stream_reactors.h"
#include "common/store/store.h"

namespace mortise::rpc {

// What files there are of one kind, and how many.
struct UploadedKind {
  std::string records;      // the kind of their records in the store: "drawings"
  std::string field;        // of the request that names one by its digest: "drawing"
  std::string full_reason;  // where there is no room: "DRAWINGS_FULL"
  int64_t most_in_one = 0;  // bytes
  int64_t most_together = int64_t{2} << 30;  // bytes
  // However small they are: each is a record and a file, and each upload looks at all of them.
  int64_t most_files = 4'000;
  // How long a file is not forgotten to make room for others: who uploads one is about to use it.
  absl::Duration grace = absl::Hours(1);
  absl::Duration life = absl::Hours(24);  // since it was last uploaded
};

// What is known of a file without reading it.
struct KeptFile {
  std::string sha256;
  int64_t bytes = 0;
  absl::Time uploaded_at;  // last
};

// A file that is coming. Nothing is kept of one that breaks off or is refused.
class IncomingFile {
 public:
  // Store and blobs outlive it.
  IncomingFile(store::Store* store, store::BlobFolder* blobs, UploadedKind kind);

  // As ChunkAssembler::Append: what is too large is refused with its first chunk, if that says so.
  absl::Status Append(const v1::Chunk& chunk);

  // Keeps the file; its digest. If all of the kind together would take more than they may, or be
  // more than they may be, those that were last uploaded longest ago are forgotten, but none within
  // the grace. RESOURCE_EXHAUSTED with the kind's reason if that makes no room, saying which limit
  // it is and when there will be some; fails as ChunkAssembler does.
  absl::StatusOr<std::string> Keep();

 private:
  absl::Status MakeRoom(const std::string& sha256);
  absl::Status PutRecord(const std::string& sha256);
  absl::Status CheckRoomBeside(const std::vector<KeptFile>& others) const;

  store::Store& store_;
  store::BlobFolder* const blobs_;
  const UploadedKind kind_;
  ChunkAssembler assembler_;
  int64_t bytes_ = 0;
};

// The receiving side of an upload method, whose response has the digest as `sha256`.
template <class Response>
class UploadedFileReader final : public UploadReader<v1::Chunk, Response> {
 public:
  UploadedFileReader(store::Store* store, store::BlobFolder* blobs, UploadedKind kind)
      : file_(store, blobs, std::move(kind)) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override { return file_.Append(chunk); }

  absl::StatusOr<Response> Complete() override {
    absl::StatusOr<std::string> digest = file_.Keep();
    if (!digest.ok()) return digest.status();
    Response response;
    response.set_sha256(*std::move(digest));
    return response;
  }

 private:
  IncomingFile file_;
};

// Returns the bytes of a file that was uploaded. INVALID_ARGUMENT naming the kind's field for one
// that was not.
absl::StatusOr<std::string> GetUploaded(store::Store& store, store::BlobFolder* blobs,
                                        const UploadedKind& kind, const std::string& sha256);

// Forgets the files that were last uploaded before `time`. Returns how many.
absl::StatusOr<int64_t> ForgetUploaded(store::Store& store, store::BlobFolder* blobs,
                                       const UploadedKind& kind, absl::Time time);

// Forgets the files that have outlived their kind, and removes from `folder`, where the blobs are,
// uploads that broke off with the process that received them as long ago. What fails is logged: it
// is done again and again (common/base/repeated_work.h).
void TidyUploads(store::Store& store, store::BlobFolder* blobs, const std::filesystem::path& folder,
                 const UploadedKind& kind);

}  // namespace mortise::rpc
