#include "common/base/log_rotation.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <system_error>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace mortise {
namespace {

constexpr double kMegabyte = 1e6;
constexpr double kDefaultMegabytes = 10;

std::filesystem::path Older(const std::filesystem::path& file, int age) {
  return age == 0 ? file : std::filesystem::path(absl::StrCat(file.string(), ".", age));
}

}  // namespace

std::optional<LogRotation> LogRotation::FromEnvironment() {
  const char* const file = std::getenv("MORTISE_LOG_FILE");
  if (file == nullptr || *file == '\0') return std::nullopt;
  const char* const size = std::getenv("MORTISE_LOG_MEGABYTES");
  double megabytes = kDefaultMegabytes;
  const bool is_number =
      size != nullptr && absl::SimpleAtod(size, &megabytes) && megabytes > 0 && megabytes < 1e6;
  return LogRotation{
      file, static_cast<std::int64_t>((is_number ? megabytes : kDefaultMegabytes) * kMegabyte)};
}

void LogRotation::BeginNewFileIfFull() const {
  struct stat written = {}, named = {};
  if (::fstat(STDERR_FILENO, &written) != 0 || written.st_size < size) return;
  const bool is_ours = ::stat(file.c_str(), &named) == 0 && named.st_dev == written.st_dev &&
                       named.st_ino == written.st_ino;
  if (!is_ours) return;
  std::error_code ignored;
  for (int age = kKeptLogFiles; age > 0; --age) {
    std::filesystem::rename(Older(file, age - 1), Older(file, age), ignored);
  }
  const int fresh = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fresh < 0) return;  // the renamed file takes what comes
  ::dup2(fresh, STDOUT_FILENO);
  ::dup2(fresh, STDERR_FILENO);
  ::close(fresh);
}

}  // namespace mortise
