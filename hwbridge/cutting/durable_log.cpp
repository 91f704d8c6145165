#include "hwbridge/cutting/durable_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <boost/crc.hpp>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/files.h"

namespace mortise::hwbridge {
namespace {

constexpr std::size_t kChecksumDigits = 8;

std::string Checksum(std::string_view text) {
  boost::crc_32_type crc;
  crc.process_bytes(text.data(), text.size());
  return absl::StrFormat("%08x", crc.checksum());
}

// Whether `line` (without line feed) carries its own checksum.
bool Intact(std::string_view line) {
  if (line.size() < kChecksumDigits + 1 || line[kChecksumDigits] != ' ') return false;
  return Checksum(line.substr(kChecksumDigits + 1)) == line.substr(0, kChecksumDigits);
}

// A new file must be findable after a power cut, so its folder is flushed too.
absl::Status FlushFolder(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return StorageFailed(folder.string(), std::strerror(errno));
  const bool flushed = ::fsync(descriptor) == 0;
  const int error = errno;
  ::close(descriptor);
  return flushed ? absl::OkStatus() : StorageFailed(folder.string(), std::strerror(error));
}

}  // namespace

std::string FormatLogLine(std::string_view text) {
  std::string line = Checksum(text);
  line.append(" ").append(text).append("\n");
  return line;
}

absl::StatusOr<ParsedLog> ParseLog(std::string_view bytes) {
  ParsedLog parsed;
  bool damaged = false;
  int number = 0;
  std::size_t start = 0;
  while (start < bytes.size()) {
    ++number;
    const std::size_t end = bytes.find('\n', start);
    const bool whole = end != std::string_view::npos;
    const std::string_view line = bytes.substr(start, whole ? end - start : end);
    if (!whole || !Intact(line)) {
      damaged = true;
    } else if (damaged) {
      return absl::DataLossError(
          absl::StrCat("line ", number, " is intact but a line before it is damaged"));
    } else {
      parsed.lines.emplace_back(line.substr(kChecksumDigits + 1));
      parsed.intact_bytes = end + 1;
    }
    if (!whole) break;
    start = end + 1;
  }
  return parsed;
}

DurableLog::DurableLog(std::filesystem::path path, const Options& options, int descriptor)
    : path_(std::move(path)), options_(options), descriptor_(descriptor) {}

DurableLog::~DurableLog() { ::close(descriptor_); }

absl::StatusOr<std::unique_ptr<DurableLog>> DurableLog::Open(const std::filesystem::path& path,
                                                             const Options& options) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor < 0) return StorageFailed(path.string(), std::strerror(errno));
  std::unique_ptr<DurableLog> log(new DurableLog(path, options, descriptor));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return PreconditionFailed("JOURNAL_IN_USE",
                              absl::StrCat(path.string(), " is in use by another process"));
  }
  MORTISE_RETURN_IF_ERROR(log->Read());
  if (options.flush) MORTISE_RETURN_IF_ERROR(FlushFolder(path));
  return log;
}

absl::Status DurableLog::Read() {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path_));
  absl::StatusOr<ParsedLog> parsed = ParseLog(bytes);
  if (!parsed.ok()) {
    return absl::DataLossError(absl::StrCat(path_.string(), ": ", parsed.status().message()));
  }
  lines_ = std::move(parsed->lines);
  size_ = static_cast<long>(parsed->intact_bytes);
  if (parsed->intact_bytes == bytes.size()) return absl::OkStatus();
  if (::ftruncate(descriptor_, size_) == 0) return absl::OkStatus();
  return StorageFailed(path_.string(), std::strerror(errno));
}

std::vector<std::string> DurableLog::TakeLines() { return std::exchange(lines_, {}); }

absl::Status DurableLog::Append(std::string_view text) {
  if (broken_) return StorageFailed(path_.string(), "an earlier write failed");
  const std::string line = FormatLogLine(text);
  const ssize_t written = ::write(descriptor_, line.data(), line.size());
  const bool safe = written == static_cast<ssize_t>(line.size()) &&
                    (!options_.flush || ::fdatasync(descriptor_) == 0);
  if (safe) {
    size_ += written;
    return absl::OkStatus();
  }
  const std::string message = std::strerror(errno);
  // After a failed flush nobody knows what the disk holds, so only a reopened file may go on.
  broken_ = written == static_cast<ssize_t>(line.size()) || ::ftruncate(descriptor_, size_) != 0;
  return StorageFailed(path_.string(), message);
}

}  // namespace mortise::hwbridge
