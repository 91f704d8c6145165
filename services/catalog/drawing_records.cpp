// Uploads of drawings, and what becomes of them.
#include "services/catalog/drawing_records.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/step_reader.h"
#include "common/rpc/chunk_stream.h"

namespace mortise::catalog {
namespace {

constexpr const char* kDrawings = "drawings";
constexpr std::size_t kDigest = 64;  // characters
constexpr int kPage = 1000;

bool IsDigest(const std::string& text) {
  return text.size() == kDigest && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

// Writes the record of a blob that is there, or says again that it is wanted.
absl::Status KeepRecord(store::Transaction& transaction, store::BlobFolder* blobs,
                        const std::string& sha256) {
  const absl::Status there = blobs->Size(sha256).status();
  if (absl::IsNotFound(there)) {
    return absl::UnavailableError("the drawing was forgotten while it came again: upload it again");
  }
  MORTISE_RETURN_IF_ERROR(there);
  return transaction.Put(kDrawings, sha256, "").status();
}

// Removes a blob that no record names.
absl::Status RemoveUnlessKept(store::Store* store, store::BlobFolder* blobs,
                              const std::string& sha256) {
  return store->Transact([&](store::Transaction& transaction) {
    const absl::Status kept = transaction.Get(kDrawings, sha256).status();
    return absl::IsNotFound(kept) ? blobs->Remove(sha256) : kept;
  });
}

class DrawingReader final : public rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse> {
 public:
  DrawingReader(store::Store* store, store::BlobFolder* blobs)
      : store_(store), blobs_(blobs), assembler_(blobs, cad::kMaxStepBytes) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override {
    if (chunk.sha256().empty()) return assembler_.Append(chunk);
    // Compared at the end, where what differs can be removed again.
    if (chunk.offset() == 0) expected_ = chunk.sha256();
    v1::Chunk unnamed = chunk;
    unnamed.clear_sha256();
    return assembler_.Append(unnamed);
  }

  absl::StatusOr<v1::UploadDrawingResponse> Complete() override {
    v1::UploadDrawingResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Finish());
    const std::string& digest = response.sha256();
    if (!expected_.empty() && expected_ != digest) {
      MORTISE_RETURN_IF_ERROR(RemoveUnlessKept(store_, blobs_, digest));
      return InvalidField("sha256", "differs from the digest of what arrived");
    }
    MORTISE_RETURN_IF_ERROR(store_->Transact(
        [&](store::Transaction& transaction) { return KeepRecord(transaction, blobs_, digest); }));
    return response;
  }

 private:
  store::Store* const store_;
  store::BlobFolder* const blobs_;
  rpc::ChunkAssembler assembler_;
  std::string expected_;
};

}  // namespace

std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>> ReceiveDrawing(
    store::Store* store, store::BlobFolder* blobs) {
  return std::make_unique<DrawingReader>(store, blobs);
}

absl::StatusOr<std::string> GetDrawing(store::Store* store, store::BlobFolder* blobs,
                                       const std::string& sha256) {
  if (!IsDigest(sha256)) {
    return InvalidField("drawing", "must be 64 lower-case hexadecimal digits");
  }
  const absl::Status kept = store->Read([&](store::ReadTransaction& transaction) {
    return transaction.Get(kDrawings, sha256).status();
  });
  const absl::StatusOr<std::string> bytes =
      kept.ok() ? blobs->Get(sha256) : absl::StatusOr<std::string>(kept);
  if (absl::IsNotFound(bytes.status())) {
    return InvalidField("drawing", "has not been uploaded, or was forgotten since");
  }
  return bytes;
}

absl::StatusOr<int64_t> ForgetDrawings(store::Store* store, store::BlobFolder* blobs,
                                       absl::Time time) {
  std::vector<std::string> old;
  MORTISE_RETURN_IF_ERROR(store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
    old.clear();
    store::ListOptions list;
    list.limit = kPage;
    while (true) {
      MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                               transaction.List(kDrawings, list));
      for (const store::Record& record : page) {
        if (record.updated_at < time) old.push_back(record.key);
      }
      if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
      list.after_key = page.back().key;
    }
  }));
  int64_t forgotten = 0;
  for (const std::string& key : old) {
    MORTISE_RETURN_IF_ERROR(store->Transact([&](store::Transaction& transaction) -> absl::Status {
      const absl::StatusOr<store::Record> record = transaction.Get(kDrawings, key);
      if (absl::IsNotFound(record.status())) return absl::OkStatus();
      MORTISE_RETURN_IF_ERROR(record.status());
      if (record->updated_at >= time) return absl::OkStatus();  // it came again
      MORTISE_RETURN_IF_ERROR(blobs->Remove(key));
      return transaction.Delete(kDrawings, key);
    }));
    ++forgotten;
  }
  return forgotten;
}

}  // namespace mortise::catalog
