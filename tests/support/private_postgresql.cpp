#include "tests/support/private_postgresql.h"

#include <pwd.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "tests/support/file_watch.h"

namespace mortise::testing {
namespace {

constexpr const char* kServerUser = "postgres";

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

// Never root, which the server refuses.
ChildProcess::Options AsServerUser() { return {.user = ::geteuid() == 0 ? kServerUser : ""}; }

absl::Status GiveToServerUser(const std::filesystem::path& folder) {
  if (::geteuid() != 0) return absl::OkStatus();
  const passwd* user = ::getpwnam(kServerUser);
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
  MORTISE_RETURN_IF_ERROR(GiveToServerUser(cluster->folder_.path()));
  ChildProcess initdb(
      {cluster->programs_ + "/initdb", "--pgdata=" + (cluster->folder_.path() / "data").string(),
       "--username=postgres", "--auth=trust", "--encoding=UTF8", "--no-locale", "--no-sync"},
      AsServerUser());
  if (initdb.Wait() != 0) return absl::InternalError("initdb failed: " + initdb.Output());
  MORTISE_RETURN_IF_ERROR(cluster->StartServer());
  return cluster;
}

absl::Status PrivatePostgresql::StartServer() {
  const std::filesystem::path& folder = folder_.path();
  server_ = std::make_unique<ChildProcess>(
      std::vector<std::string>{programs_ + "/postgres", "-D", (folder / "data").string(), "-k",
                               folder.string(), "-c", "listen_addresses=", "-c", "fsync=off", "-c",
                               "max_connections=200", "-c", "shared_buffers=64MB"},
      AsServerUser());
  const bool ready = WaitForFiles(
      folder / "data", [this] { return Ready(); }, ChildProcess::kPatience,
      server_->end_descriptor());
  if (ready) return absl::OkStatus();
  return absl::InternalError("the PostgreSQL server does not start: " + server_->Output());
}

// The server tells pg_ctl, and whoever reads it, how far it is: its process id is the first line of
// postmaster.pid, and its state the eighth.
bool PrivatePostgresql::Ready() const {
  std::ifstream file(folder_.path() / "data" / "postmaster.pid");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (number == 1 && line != absl::StrCat(server_->pid())) return false;
    if (number == 8) return line.rfind("ready", 0) == 0;
  }
  return false;
}

PrivatePostgresql::~PrivatePostgresql() {
  if (server_) server_->End(SIGQUIT);  // what it shares with its children goes with it
}

std::string PrivatePostgresql::url() const {
  return "postgresql://postgres@/postgres?host=" + folder_.path().string();
}

absl::Status PrivatePostgresql::CrashAndRestart() {
  server_->End(SIGQUIT);  // "immediate": no checkpoint, recovery at the next start
  return StartServer();
}

}  // namespace mortise::testing
