#include "tests/support/private_postgresql.h"

#include <fcntl.h>
#include <libpq-fe.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/errors.h"

namespace mortise::testing {
namespace {

constexpr absl::Duration kStartTime = absl::Seconds(60);

// The newest installed version's folder; empty if there is none.
std::string FindPrograms() {
  std::string best;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/usr/lib/postgresql", ignored)) {
    const std::filesystem::path programs = entry.path() / "bin";
    if (std::filesystem::exists(programs / "initdb")) best = std::max(best, programs.string());
  }
  return best;
}

// In the child: never root, ends when the test does, and runs the program.
[[noreturn]] void RunAs(const passwd* user, const std::vector<std::string>& command,
                        const std::string& log) {
  if (user != nullptr && (::setgid(user->pw_gid) != 0 || ::setuid(user->pw_uid) != 0)) ::_exit(127);
  ::prctl(PR_SET_PDEATHSIG, SIGQUIT);
  const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& argument : command)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

pid_t Launch(const std::vector<std::string>& command, const std::string& log) {
  const passwd* user = ::geteuid() == 0 ? ::getpwnam("postgres") : nullptr;
  const pid_t child = ::fork();
  if (child == 0) RunAs(user, command, log);
  return child;
}

absl::Status GiveToServerUser(const std::filesystem::path& folder) {
  if (::geteuid() != 0) return absl::OkStatus();
  const passwd* user = ::getpwnam("postgres");
  if (user == nullptr) return absl::NotFoundError("there is no user 'postgres'");
  if (::chown(folder.c_str(), user->pw_uid, user->pw_gid) != 0) {
    return absl::InternalError("chown failed: " + folder.string());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<PrivatePostgresql>> PrivatePostgresql::Start() {
  std::unique_ptr<PrivatePostgresql> cluster(new PrivatePostgresql);
  cluster->programs_ = FindPrograms();
  if (cluster->programs_.empty()) {
    return absl::NotFoundError("PostgreSQL is not installed (Debian package postgresql)");
  }
  const std::filesystem::path& folder = cluster->folder_.path();
  MORTISE_RETURN_IF_ERROR(GiveToServerUser(folder));
  const pid_t initdb =
      Launch({cluster->programs_ + "/initdb", "--pgdata=" + (folder / "data").string(),
              "--username=postgres", "--auth=trust", "--encoding=UTF8", "--no-locale", "--no-sync"},
             (folder / "log").string());
  int result = -1;
  if (::waitpid(initdb, &result, 0) != initdb || result != 0) {
    return absl::InternalError("initdb failed");
  }
  MORTISE_RETURN_IF_ERROR(cluster->StartServer());
  return cluster;
}

absl::Status PrivatePostgresql::StartServer() {
  const std::filesystem::path& folder = folder_.path();
  server_ = Launch({programs_ + "/postgres", "-D", (folder / "data").string(), "-k",
                    folder.string(), "-c", "listen_addresses=", "-c", "fsync=off", "-c",
                    "max_connections=200", "-c", "shared_buffers=64MB"},
                   (folder / "log").string());
  const absl::Time deadline = absl::Now() + kStartTime;
  while (PQping(url().c_str()) != PQPING_OK) {
    if (absl::Now() > deadline || ::waitpid(server_, nullptr, WNOHANG) != 0) {
      return absl::InternalError("the PostgreSQL server does not start");
    }
    absl::SleepFor(absl::Milliseconds(20));
  }
  return absl::OkStatus();
}

void PrivatePostgresql::StopServer(int signal) {
  if (server_ <= 0) return;
  ::kill(server_, signal);
  ::waitpid(server_, nullptr, 0);
  server_ = -1;
}

PrivatePostgresql::~PrivatePostgresql() { StopServer(SIGQUIT); }

std::string PrivatePostgresql::url() const {
  return "postgresql://postgres@/postgres?host=" + folder_.path().string();
}

absl::Status PrivatePostgresql::CrashAndRestart() {
  StopServer(SIGQUIT);  // "immediate": no checkpoint, recovery at the next start
  return StartServer();
}

}  // namespace mortise::testing
