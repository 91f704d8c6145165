// What tests start does not outlive them, even when they crash.
#include "tests/e2e/command.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <system_error>

#include "tests/support/file_watch.h"
#include "tests/support/temporary_folder.h"

namespace mortise::e2e {
namespace {

// Whether a process, which need not be a child, ends within ten seconds.
bool Ends(pid_t process) {
  try {
    const testing::ProcessEnd end(process);
    pollfd ended = {end.descriptor(), POLLIN, 0};
    return ::poll(&ended, 1, 10000) == 1;
  } catch (const std::system_error& error) {
    return error.code() == std::errc::no_such_process;
  }
}

TEST(BackgroundCommand, DoesNotOutliveATestThatCrashes) {
  const testing::TemporaryFolder folder;
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const pid_t crashing = ::fork();
  if (crashing == 0) {
    const auto command =
        BackgroundCommand::InShell("sleep 600", folder.path(), (folder.path() / "log").string());
    const pid_t pid = command->pid();
    ::_exit(::write(pipe[1], &pid, sizeof(pid)) == sizeof(pid) ? 0 : 1);  // without destructors
  }
  pid_t started = 0;
  ASSERT_EQ(::read(pipe[0], &started, sizeof(started)), static_cast<ssize_t>(sizeof(started)));
  ASSERT_EQ(::waitpid(crashing, nullptr, 0), crashing);
  EXPECT_TRUE(Ends(started));
  ::kill(started, SIGKILL);  // where that failed
  ::close(pipe[0]);
  ::close(pipe[1]);
}

}  // namespace
}  // namespace mortise::e2e
