// Uploads of drawings, and what becomes of them.
#include "services/catalog/records/drawing_records.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/step/step_reader.h"
#include "common/host/chunk_stream.h"

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

// What is known of a drawing without reading it.
struct KeptDrawing {
  std::string sha256;
  int64_t bytes = 0;
  absl::Time uploaded_at;
};

std::string PayloadOf(int64_t bytes) { return nlohmann::json{{"bytes", bytes}}.dump(); }

// Records of earlier versions are empty: their blobs say how large they are.
int64_t BytesOf(const store::Record& record, store::BlobFolder* blobs) {
  const auto json = nlohmann::json::parse(record.payload, nullptr, false);
  if (json.is_object() && json.contains("bytes") && json["bytes"].is_number_integer()) {
    return json["bytes"].get<int64_t>();
  }
  return static_cast<int64_t>(blobs->Size(record.key).value_or(0));
}

absl::StatusOr<std::vector<KeptDrawing>> ListDrawings(store::ReadTransaction& transaction,
                                                      store::BlobFolder* blobs) {
  std::vector<KeptDrawing> drawings;
  store::ListOptions list;
  list.limit = kPage;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                             transaction.List(kDrawings, list));
    for (const store::Record& record : page) {
      drawings.push_back({record.key, BytesOf(record, blobs), record.updated_at});
    }
    if (static_cast<int>(page.size()) < kPage) return drawings;
    list.after_key = page.back().key;
  }
}

absl::StatusOr<std::vector<KeptDrawing>> ListDrawings(store::Store& store,
                                                      store::BlobFolder* blobs) {
  std::vector<KeptDrawing> drawings;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(drawings, ListDrawings(transaction, blobs));
    return absl::OkStatus();
  }));
  return drawings;
}

int64_t TotalBytes(const std::vector<KeptDrawing>& drawings) {
  int64_t bytes = 0;
  for (const KeptDrawing& drawing : drawings) bytes += drawing.bytes;
  return bytes;
}

// Forgets a drawing unless it came again at `time` or later. The blob goes while the record is
// locked by its deletion: an upload of the same drawing either was before, which is seen here, or
// puts its blob into place afterwards.
absl::StatusOr<bool> Forget(store::Store& store, store::BlobFolder* blobs,
                            const std::string& sha256, absl::Time time) {
  bool forgotten = false;
  MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
    forgotten = false;
    const absl::StatusOr<store::Record> record = transaction.Get(kDrawings, sha256);
    if (absl::IsNotFound(record.status())) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(record.status());
    if (record->updated_at >= time) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(transaction.Delete(kDrawings, sha256));
    forgotten = true;
    return blobs->Remove(sha256);
  }));
  return forgotten;
}

class DrawingReader final : public rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse> {
 public:
  DrawingReader(store::Store* store, store::BlobFolder* blobs, int64_t most)
      : store_(*store), blobs_(blobs), most_(most), assembler_(blobs, cad::kMaxStepBytes) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override {
    bytes_ += static_cast<int64_t>(chunk.data().size());
    return assembler_.Append(chunk);
  }

  absl::StatusOr<v1::UploadDrawingResponse> Complete() override {
    v1::UploadDrawingResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Digest());
    MORTISE_RETURN_IF_ERROR(MakeRoom(response.sha256()));
    MORTISE_RETURN_IF_ERROR(PutRecord(response.sha256()));
    // Should this fail, the record goes in time: another upload of the same may rely on it.
    MORTISE_RETURN_IF_ERROR(assembler_.Finish().status());
    return response;
  }

 private:
  // Forgets the oldest drawings as far as this one needs it, and none if that is not enough.
  absl::Status MakeRoom(const std::string& sha256) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<KeptDrawing> drawings, ListDrawings(store_, blobs_));
    std::erase_if(drawings, [&](const KeptDrawing& each) { return each.sha256 == sha256; });
    const absl::Time spared = store_.Now() - kDrawingGrace;
    std::sort(drawings.begin(), drawings.end(), [](const KeptDrawing& a, const KeptDrawing& b) {
      return a.uploaded_at < b.uploaded_at;
    });
    const auto young = std::find_if(drawings.begin(), drawings.end(), [&](const KeptDrawing& each) {
      return each.uploaded_at >= spared;
    });
    const int64_t of_young = TotalBytes({young, drawings.end()});
    if (of_young + bytes_ > most_) return NoRoom(of_young);
    int64_t together = TotalBytes(drawings) + bytes_;
    for (auto old = drawings.begin(); old != young && together > most_; ++old) {
      MORTISE_RETURN_IF_ERROR(Forget(store_, blobs_, old->sha256, spared).status());
      together -= old->bytes;
    }
    return absl::OkStatus();
  }

  absl::Status PutRecord(const std::string& sha256) {
    return store_.Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(std::vector<KeptDrawing> others, ListDrawings(transaction, blobs_));
      std::erase_if(others, [&](const KeptDrawing& each) { return each.sha256 == sha256; });
      if (TotalBytes(others) + bytes_ > most_) return NoRoom(TotalBytes(others));
      return transaction.Put(kDrawings, sha256, PayloadOf(bytes_)).status();
    });
  }

  absl::Status NoRoom(int64_t beside) const {
    return WithDetail(
        absl::ResourceExhaustedError(absl::StrCat(
            "the drawings uploaded within the last hour take ", beside, " of ", most_,
            " bytes, which leaves no room for ", bytes_, " more: upload it again later")),
        {"DRAWINGS_FULL", "total_size"});
  }

  store::Store& store_;
  store::BlobFolder* const blobs_;
  const int64_t most_;
  rpc::ChunkAssembler assembler_;
  int64_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>> ReceiveDrawing(
    store::Store* store, store::BlobFolder* blobs, int64_t most) {
  return std::make_unique<DrawingReader>(store, blobs, most);
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
  MORTISE_ASSIGN_OR_RETURN(const std::vector<KeptDrawing> drawings, ListDrawings(*store, blobs));
  int64_t forgotten = 0;
  for (const KeptDrawing& drawing : drawings) {
    if (drawing.uploaded_at >= time) continue;
    MORTISE_ASSIGN_OR_RETURN(const bool gone, Forget(*store, blobs, drawing.sha256, time));
    if (gone) ++forgotten;
  }
  return forgotten;
}

}  // namespace mortise::catalog
