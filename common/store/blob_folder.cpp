// Layout: the first two digits of the digest name a folder, so that none grows huge:
// <folder>/ab/ab12…; parts being written are in <folder>/parts.
#include "common/store/blob_folder.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/freed_by.h"
#include "common/base/identifiers.h"

namespace mortise::store {
namespace {

constexpr const char* kParts = "parts";
constexpr const char* kDiskFull = "the disk is full";
constexpr const char* kFileLimit = "files may not become so large here";

absl::Status Failed(const std::filesystem::path& path) {
  if (errno == ENOSPC || errno == EDQUOT) return StorageFailed(path.string(), kDiskFull);
  if (errno == EFBIG) return StorageFailed(path.string(), kFileLimit);
  return StorageFailed(path.string(), std::strerror(errno));
}

absl::Status CheckDigest(std::string_view digest) {
  const bool hexadecimal = std::all_of(digest.begin(), digest.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  });
  if (digest.size() == 64 && hexadecimal) return absl::OkStatus();
  return InvalidField("digest", "must be 64 lower-case hexadecimal digits");
}

std::filesystem::path PlaceOf(const std::filesystem::path& folder, std::string_view digest) {
  return folder / digest.substr(0, 2) / digest;
}

absl::Status NoBlob(std::string_view digest) {
  return ResourceNotFound(absl::StrCat("blobs/", std::string(digest)));
}

absl::Status CreateFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return absl::OkStatus();
  return StorageFailed(folder.string(), "the folder cannot be created: " + error.message());
}

// Makes a rename in `folder` survive a power failure.
absl::Status FlushFolder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return Failed(folder);
  const int result = ::fsync(descriptor);
  ::close(descriptor);
  return result == 0 ? absl::OkStatus() : Failed(folder);
}

class FileBlobWriter final : public BlobWriter {
 public:
  FileBlobWriter(std::filesystem::path folder, std::filesystem::path part, int descriptor)
      : folder_(std::move(folder)),
        part_(std::move(part)),
        descriptor_(descriptor),
        digest_(EVP_MD_CTX_new()) {
    EVP_DigestInit_ex(digest_.get(), EVP_sha256(), nullptr);
  }

  ~FileBlobWriter() override {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(part_.c_str());
  }

  absl::Status Append(std::string_view bytes) override {
    EVP_DigestUpdate(digest_.get(), bytes.data(), bytes.size());
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return Failed(part_);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return absl::OkStatus();
  }

  std::string Digest() const override {
    const std::unique_ptr<EVP_MD_CTX, FreedBy<EVP_MD_CTX_free>> so_far(EVP_MD_CTX_new());
    EVP_MD_CTX_copy_ex(so_far.get(), digest_.get());
    unsigned char bytes[EVP_MAX_MD_SIZE];
    unsigned int length = 0;
    EVP_DigestFinal_ex(so_far.get(), bytes, &length);
    std::string text;
    for (unsigned int i = 0; i < length; ++i) {
      absl::StrAppend(&text, absl::Hex(bytes[i], absl::kZeroPad2));
    }
    return text;
  }

  absl::StatusOr<std::string> Finish() override {
    const std::string digest = Digest();
    const std::filesystem::path place = PlaceOf(folder_, digest);
    if (::fsync(descriptor_) != 0) return Failed(part_);
    MORTISE_RETURN_IF_ERROR(CreateFolder(place.parent_path()));
    if (::rename(part_.c_str(), place.c_str()) != 0) return Failed(place);
    ::close(std::exchange(descriptor_, -1));
    MORTISE_RETURN_IF_ERROR(FlushFolder(place.parent_path()));
    return digest;
  }

 private:
  std::filesystem::path folder_;
  std::filesystem::path part_;
  int descriptor_;  // -1 once finished
  std::unique_ptr<EVP_MD_CTX, FreedBy<EVP_MD_CTX_free>> digest_;
};

}  // namespace

bool IsDiskFull(const absl::Status& status) {
  const ErrorDetail detail = DetailOf(status);
  return detail.reason == "STORAGE_FAILED" && (status == StorageFailed(detail.field, kDiskFull) ||
                                               status == StorageFailed(detail.field, kFileLimit));
}

BlobFolder::BlobFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

absl::StatusOr<std::unique_ptr<BlobFolder>> BlobFolder::Open(const std::filesystem::path& folder) {
  MORTISE_RETURN_IF_ERROR(CreateFolder(folder / kParts));
  std::unique_ptr<BlobFolder> blobs(new BlobFolder(folder));
  MORTISE_RETURN_IF_ERROR(blobs->Write().status());  // dropped: it only proves that one can write
  return blobs;
}

absl::StatusOr<std::unique_ptr<BlobWriter>> BlobFolder::Write() {
  const std::filesystem::path part = folder_ / kParts / NewIdentifier();
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) return Failed(part);
  return std::make_unique<FileBlobWriter>(folder_, part, descriptor);
}

absl::StatusOr<std::string> BlobFolder::Put(std::string_view bytes) {
  const std::string digest = Sha256Hex(bytes);
  absl::StatusOr<uint64_t> present = Size(digest);
  if (present.ok() && *present == bytes.size()) return digest;
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<BlobWriter> writer, Write());
  MORTISE_RETURN_IF_ERROR(writer->Append(bytes));
  return writer->Finish();
}

absl::StatusOr<std::string> BlobFolder::Get(std::string_view digest, std::size_t limit) {
  MORTISE_ASSIGN_OR_RETURN(const std::filesystem::path path, PathOf(digest));
  MORTISE_ASSIGN_OR_RETURN(std::string bytes, ReadFile(path, limit));
  if (Sha256Hex(bytes) != digest) {
    return WithDetail(absl::DataLossError(absl::StrCat(path.string(), " is damaged")),
                      {"BLOB_DAMAGED", absl::StrCat("blobs/", std::string(digest))});
  }
  return bytes;
}

absl::StatusOr<std::string> BlobFolder::GetRange(std::string_view digest, uint64_t offset,
                                                 std::size_t length) {
  constexpr std::size_t kLongest = std::size_t{64} << 20;
  if (length > kLongest) return TooLarge("length", "64 MiB");
  MORTISE_ASSIGN_OR_RETURN(const std::filesystem::path path, PathOf(digest));
  MORTISE_ASSIGN_OR_RETURN(const uint64_t size, Size(digest));
  if (offset >= size) return std::string();
  std::string bytes(static_cast<std::size_t>(std::min<uint64_t>(length, size - offset)), '\0');
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return Failed(path);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(descriptor, bytes.data() + done, bytes.size() - done,
                                  static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  ::close(descriptor);
  if (done < bytes.size()) return StorageFailed(path.string(), "it cannot be read");
  return bytes;
}

absl::StatusOr<uint64_t> BlobFolder::Size(std::string_view digest) {
  MORTISE_RETURN_IF_ERROR(CheckDigest(digest));
  struct stat status = {};
  if (::stat(PlaceOf(folder_, digest).c_str(), &status) != 0) return NoBlob(digest);
  return static_cast<uint64_t>(status.st_size);
}

absl::StatusOr<std::filesystem::path> BlobFolder::PathOf(std::string_view digest) {
  MORTISE_RETURN_IF_ERROR(Size(digest).status());
  return PlaceOf(folder_, digest);
}

absl::Status BlobFolder::Remove(std::string_view digest) {
  MORTISE_RETURN_IF_ERROR(CheckDigest(digest));
  const std::filesystem::path path = PlaceOf(folder_, digest);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return Failed(path);
  return absl::OkStatus();
}

}  // namespace mortise::store
