#include "tests/support/file_watch.h"

#include <poll.h>
#include <sys/inotify.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "absl/time/clock.h"

namespace mortise::testing {
namespace {

constexpr uint32_t kChanges = IN_CREATE | IN_MODIFY | IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE;

// Collects a folder's changes from its creation on.
class Watch {
 public:
  explicit Watch(const std::filesystem::path& folder)
      : descriptor_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
    if (descriptor_ >= 0 && ::inotify_add_watch(descriptor_, folder.c_str(), kChanges) >= 0) return;
    const int error = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw std::system_error(error, std::generic_category(), "watching " + folder.string());
  }
  ~Watch() { ::close(descriptor_); }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  // Waits for a change; false if the time is over or `until` is readable.
  bool Next(absl::Time deadline, int until) {
    pollfd watched[] = {{descriptor_, POLLIN, 0}, {until, POLLIN, 0}};
    while (true) {
      const absl::Duration left = std::min(deadline - absl::Now(), absl::Hours(1));
      if (left <= absl::ZeroDuration()) return false;
      const int ready = ::poll(watched, 2, static_cast<int>(absl::ToInt64Milliseconds(left)) + 1);
      if (ready < 0 && errno != EINTR) return false;
      if (ready > 0) break;
    }
    if ((watched[0].revents & POLLIN) == 0) return false;
    char changes[4096];
    while (::read(descriptor_, changes, sizeof(changes)) > 0) {
    }
    return true;
  }

 private:
  const int descriptor_;
};

}  // namespace

// Called directly: the C library's header declares it for C only.
ProcessEnd::ProcessEnd(pid_t process)
    : descriptor_(static_cast<int>(::syscall(SYS_pidfd_open, process, 0))) {
  if (descriptor_ < 0) {
    throw std::system_error(errno, std::generic_category(), "watching a process");
  }
}

ProcessEnd::~ProcessEnd() { ::close(descriptor_); }

bool WaitForFiles(const std::filesystem::path& folder, const std::function<bool()>& holds,
                  absl::Duration timeout, int until) {
  const absl::Time deadline = absl::Now() + timeout;
  Watch watch(folder);
  while (!holds()) {
    // What happened just before the end counts.
    if (!watch.Next(deadline, until)) return holds();
  }
  return true;
}

}  // namespace mortise::testing
