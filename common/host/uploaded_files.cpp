#include "common/host/uploaded_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/store/blob_folder.h"
#include "common/store/blob_upkeep.h"
#include "mortise/v1/types.pb.h"

namespace mortise::rpc {
namespace {

constexpr std::size_t kDigest = 64;  // characters
constexpr int kPage = 1000;

bool IsDigest(const std::string& text) {
  return text.size() == kDigest && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

std::string PayloadOf(int64_t bytes) { return nlohmann::json{{"bytes", bytes}}.dump(); }

// Records of earlier versions are empty: their blobs say how large they are.
int64_t BytesOf(const store::Record& record, store::BlobFolder* blobs) {
  const auto json = nlohmann::json::parse(record.payload, nullptr, false);
  if (json.is_object() && json.contains("bytes") && json["bytes"].is_number_integer()) {
    return json["bytes"].get<int64_t>();
  }
  return static_cast<int64_t>(blobs->Size(record.key).value_or(0));
}

absl::StatusOr<std::vector<KeptFile>> ListFiles(store::ReadTransaction& transaction,
                                                store::BlobFolder* blobs,
                                                const UploadedKind& kind) {
  std::vector<KeptFile> files;
  store::ListOptions list;
  list.limit = kPage;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                             transaction.List(kind.records, list));
    for (const store::Record& record : page) {
      files.push_back({record.key, BytesOf(record, blobs), record.updated_at});
    }
    if (static_cast<int>(page.size()) < kPage) return files;
    list.after_key = page.back().key;
  }
}

absl::StatusOr<std::vector<KeptFile>> ListFiles(store::Store& store, store::BlobFolder* blobs,
                                                const UploadedKind& kind) {
  std::vector<KeptFile> files;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(files, ListFiles(transaction, blobs, kind));
    return absl::OkStatus();
  }));
  return files;
}

int64_t TotalBytes(const std::vector<KeptFile>& files) {
  int64_t bytes = 0;
  for (const KeptFile& file : files) bytes += file.bytes;
  return bytes;
}

// Forgets a file unless it came again at `time` or later. The blob goes while the record is locked
// by its deletion: an upload of the same file either was before, which is seen here, or puts its
// blob into place afterwards.
absl::StatusOr<bool> Forget(store::Store& store, store::BlobFolder* blobs, const UploadedKind& kind,
                            const std::string& sha256, absl::Time time) {
  bool forgotten = false;
  MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
    forgotten = false;
    const absl::StatusOr<store::Record> record = transaction.Get(kind.records, sha256);
    if (absl::IsNotFound(record.status())) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(record.status());
    if (record->updated_at >= time) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(transaction.Delete(kind.records, sha256));
    forgotten = true;
    return blobs->Remove(sha256);
  }));
  return forgotten;
}

}  // namespace

IncomingFile::IncomingFile(store::Store* store, store::BlobFolder* blobs, UploadedKind kind)
    : store_(*store), blobs_(blobs), kind_(std::move(kind)), assembler_(blobs, kind_.most_in_one) {}

absl::Status IncomingFile::Append(const v1::Chunk& chunk) {
  bytes_ += static_cast<int64_t>(chunk.data().size());
  return assembler_.Append(chunk);
}

absl::StatusOr<std::string> IncomingFile::Keep() {
  MORTISE_ASSIGN_OR_RETURN(std::string sha256, assembler_.Digest());
  MORTISE_RETURN_IF_ERROR(MakeRoom(sha256));
  MORTISE_RETURN_IF_ERROR(PutRecord(sha256));
  // Should this fail, the record goes in time: another upload of the same may rely on it.
  MORTISE_RETURN_IF_ERROR(assembler_.Finish().status());
  return sha256;
}

// Forgets the oldest files as far as this one needs it, and none if that is not enough.
absl::Status IncomingFile::MakeRoom(const std::string& sha256) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<KeptFile> files, ListFiles(store_, blobs_, kind_));
  std::erase_if(files, [&](const KeptFile& each) { return each.sha256 == sha256; });
  const absl::Time spared = store_.Now() - kind_.grace;
  std::sort(files.begin(), files.end(),
            [](const KeptFile& a, const KeptFile& b) { return a.uploaded_at < b.uploaded_at; });
  const auto young = std::find_if(files.begin(), files.end(),
                                  [&](const KeptFile& each) { return each.uploaded_at >= spared; });
  MORTISE_RETURN_IF_ERROR(CheckRoomBeside({young, files.end()}));
  int64_t together = TotalBytes(files) + bytes_;
  auto count = static_cast<int64_t>(files.size()) + 1;
  for (auto old = files.begin();
       old != young && (together > kind_.most_together || count > kind_.most_files); ++old) {
    MORTISE_RETURN_IF_ERROR(Forget(store_, blobs_, kind_, old->sha256, spared).status());
    together -= old->bytes;
    --count;
  }
  return absl::OkStatus();
}

absl::Status IncomingFile::PutRecord(const std::string& sha256) {
  return store_.Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(std::vector<KeptFile> others, ListFiles(transaction, blobs_, kind_));
    std::erase_if(others, [&](const KeptFile& each) { return each.sha256 == sha256; });
    MORTISE_RETURN_IF_ERROR(CheckRoomBeside(others));
    return transaction.Put(kind_.records, sha256, PayloadOf(bytes_)).status();
  });
}

// Whether this file has room beside others that stay.
absl::Status IncomingFile::CheckRoomBeside(const std::vector<KeptFile>& others) const {
  const int64_t together = TotalBytes(others);
  const auto count = static_cast<int64_t>(others.size());
  const bool are_too_many = count + 1 > kind_.most_files;
  if (!are_too_many && together + bytes_ <= kind_.most_together) return absl::OkStatus();
  const std::string limit =
      are_too_many ? absl::StrCat(count, " of ", kind_.most_files, " that there may be")
                   : absl::StrCat(together, " of ", kind_.most_together,
                                  " bytes that all may take, and this one has ", bytes_);
  const auto oldest = std::min_element(
      others.begin(), others.end(),
      [](const KeptFile& a, const KeptFile& b) { return a.uploaded_at < b.uploaded_at; });
  const std::string advice =
      oldest == others.end()
          ? ""
          : absl::StrCat(
                "; the oldest of them makes room in ",
                absl::FormatDuration(absl::Ceil(
                    std::max(oldest->uploaded_at + kind_.grace - store_.Now(), absl::Seconds(1)),
                    absl::Seconds(1))),
                ": upload it again then");
  return WithDetail(absl::ResourceExhaustedError(absl::StrCat(
                        "there is no room for more ", kind_.records, ": those of the last ",
                        absl::FormatDuration(kind_.grace), " are ", limit, advice)),
                    {kind_.full_reason, are_too_many ? "sha256" : "total_size"});
}

absl::StatusOr<std::string> GetUploaded(store::Store& store, store::BlobFolder* blobs,
                                        const UploadedKind& kind, const std::string& sha256) {
  if (!IsDigest(sha256)) {
    return InvalidField(kind.field, "must be 64 lower-case hexadecimal digits");
  }
  const absl::Status kept = store.Read([&](store::ReadTransaction& transaction) {
    return transaction.Get(kind.records, sha256).status();
  });
  const absl::StatusOr<std::string> bytes =
      kept.ok() ? blobs->Get(sha256) : absl::StatusOr<std::string>(kept);
  if (absl::IsNotFound(bytes.status())) {
    return InvalidField(kind.field, "has not been uploaded, or was forgotten since");
  }
  return bytes;
}

absl::StatusOr<int64_t> ForgetUploaded(store::Store& store, store::BlobFolder* blobs,
                                       const UploadedKind& kind, absl::Time time) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<KeptFile> files, ListFiles(store, blobs, kind));
  int64_t forgotten = 0;
  for (const KeptFile& file : files) {
    if (file.uploaded_at >= time) continue;
    MORTISE_ASSIGN_OR_RETURN(const bool gone, Forget(store, blobs, kind, file.sha256, time));
    if (gone) ++forgotten;
  }
  return forgotten;
}

void TidyUploads(store::Store& store, store::BlobFolder* blobs, const std::filesystem::path& folder,
                 const UploadedKind& kind) {
  const auto forgotten = ForgetUploaded(store, blobs, kind, store.Now() - kind.life);
  if (!forgotten.ok()) {
    Log(LogLevel::kWarning, absl::StrCat("old ", kind.records, " could not be removed"),
        {{"error", forgotten.status().ToString()}});
  } else if (*forgotten > 0) {
    Log(LogLevel::kInfo, absl::StrCat("forgot ", kind.records, " that were uploaded"),
        {{kind.records, *forgotten}});
  }
  const auto abandoned = store::RemoveAbandonedParts(folder, absl::Now() - kind.life);
  if (!abandoned.ok()) {
    Log(LogLevel::kWarning, "unfinished uploads could not be removed",
        {{"error", abandoned.status().ToString()}});
  }
}

}  // namespace mortise::rpc
