// An append-only file of checksummed lines: what a journal needs to survive a power cut.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::hwbridge {

// Each line is eight hexadecimal digits of CRC-32, a space, and the text. A last line that is torn
// (the power went while it was written, so nobody was told that it was safe) is cut off on opening.
class DurableLog {
 public:
  struct Options {
    bool flush = true;  // false: survives the death of the process, but not a power cut
  };

  // Opens or creates `path` and locks it against other processes. FAILED_PRECONDITION
  // (JOURNAL_IN_USE) if it is locked; DATA_LOSS if a damaged line has an intact one after it.
  static absl::StatusOr<std::unique_ptr<DurableLog>> Open(const std::filesystem::path& path,
                                                          const Options& options);
  ~DurableLog();
  DurableLog(const DurableLog&) = delete;
  DurableLog& operator=(const DurableLog&) = delete;

  // The texts found on opening, in order; leaves none behind.
  std::vector<std::string> TakeLines();

  // Returns after `text`, which has no line feed, is safe on disk. Where that fails the file is as
  // it was before, or refuses everything from then on.
  absl::Status Append(std::string_view text);

 private:
  DurableLog(std::filesystem::path path, const Options& options, int descriptor);
  absl::Status Read();

  std::filesystem::path path_;
  Options options_;
  int descriptor_;
  long size_ = 0;  // bytes of intact lines
  bool broken_ = false;
  std::vector<std::string> lines_;
};

// The intact lines of `bytes` and how many bytes they take. DATA_LOSS as Open.
struct ParsedLog {
  std::vector<std::string> lines;
  std::size_t intact_bytes = 0;
};
absl::StatusOr<ParsedLog> ParseLog(std::string_view bytes);

// A line as it stands in the file, with its line feed.
std::string FormatLogLine(std::string_view text);

}  // namespace mortise::hwbridge
