// The journal reads any file: it refuses it or holds together.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "hwbridge/cutting/durable_log.h"
#include "hwbridge/cutting/journal.h"

namespace {

std::string WithChecksums(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    bytes += mortise::hwbridge::FormatLogLine(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return bytes;
}

void OpenJournal(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  auto journal = mortise::hwbridge::Journal::Open(path, {.flush = false});
  if (!journal.ok()) return;
  (void)(*journal)->OpenCuts("saw");
  const auto next = (*journal)->NextReportNumber();
  const std::string alarm = (*journal)->Alarm("saw");
  const auto echo = (*journal)->LastEcho("saw");
  journal->reset();
  // What was accepted once is accepted again, and says the same.
  auto again = mortise::hwbridge::Journal::Open(path, {.flush = false});
  if (!again.ok() || (*again)->NextReportNumber() != next) std::abort();
  if ((*again)->Alarm("saw") != alarm || (*again)->LastEcho("saw") != echo) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto path = std::filesystem::temp_directory_path() /
                    ("hwbridge-journal-fuzz-" + std::to_string(::getpid()));
  OpenJournal(path, bytes);
  OpenJournal(path, WithChecksums(bytes));
  std::filesystem::remove(path);
  return 0;
}
