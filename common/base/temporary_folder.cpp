#include "common/base/temporary_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "common/base/identifiers.h"

namespace mortise {
namespace {

// For what was made and is not locked yet.
constexpr std::chrono::minutes kMinAge(1);

std::string PrefixOf(std::string_view purpose) {
  return absl::StrCat("mortise-", absl::string_view(purpose.data(), purpose.size()), "-");
}

// Opens and locks a folder; -1 where another process has it, or it is another user's.
int Hold(const std::filesystem::path& folder) {
  const int held = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (held < 0 || flock(held, LOCK_EX | LOCK_NB) == 0) return held;
  close(held);
  return -1;
}

// Removes the folders for this purpose that no process holds any more.
void RemoveAbandoned(std::string_view purpose) {
  const std::string prefix = PrefixOf(purpose);
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(std::filesystem::temp_directory_path(failed),
                                                 failed);
       !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed)) {
    if (!entry->path().filename().string().starts_with(prefix)) continue;
    std::error_code ignored;
    const auto written = std::filesystem::last_write_time(entry->path(), ignored);
    if (ignored || std::filesystem::file_time_type::clock::now() - written < kMinAge) continue;
    const int held = Hold(entry->path());
    if (held < 0) continue;
    std::filesystem::remove_all(entry->path(), ignored);
    close(held);
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder(std::string_view purpose)
    : path_(std::filesystem::temp_directory_path() /
            absl::StrCat(PrefixOf(purpose), NewIdentifier())) {
  RemoveAbandoned(purpose);
  std::error_code ignored;
  if (!std::filesystem::create_directory(path_, ignored)) return;
  std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
  held_ = Hold(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (held_ >= 0) close(held_);
}

}  // namespace mortise
