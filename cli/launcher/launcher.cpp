#include "cli/launcher/launcher.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "common/base/process.h"

namespace mortise::cli {
namespace {

using std::chrono::milliseconds;

constexpr int kDeathsBeforeGivingUp = 5;
constexpr milliseconds kFirstBackOff{100};
constexpr milliseconds kMaxBackOff{5000};
constexpr std::chrono::seconds kLongEnoughToForgive{10};

std::string LastLines(const std::filesystem::path& path) {
  const absl::StatusOr<std::string> text = ReadFile(path);
  if (!text.ok()) return "";
  constexpr std::size_t kShown = 2000;
  return text->size() > kShown ? text->substr(text->size() - kShown) : *text;
}

// The time of processors that a process has taken, in ticks of the kernel; 0 if it has ended. Its
// line in /proc is "pid (name) state …", and a name may have blanks and parentheses.
std::int64_t ProcessorTicks(pid_t pid) {
  std::string line;
  std::getline(std::ifstream(absl::StrCat("/proc/", pid, "/stat")), line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream words(line.substr(name_end + 1));
  constexpr int kBeforeUserTime = 11;
  std::string ignored;
  for (int i = 0; i < kBeforeUserTime; ++i) words >> ignored;
  std::int64_t user = 0, system = 0;
  words >> user >> system;
  return user + system;
}

}  // namespace

Launcher::Launcher(HouseOptions options, HousePlan plan,
                   std::function<void(const RunningHouse&)> changed)
    : options_(std::move(options)),
      plan_(std::move(plan)),
      changed_(std::move(changed)),
      children_(plan_.processes.size()) {}

Launcher::~Launcher() { Stop(milliseconds(2000)); }

absl::Status Launcher::Start() {
  for (std::size_t i = 0; i < children_.size(); ++i) MORTISE_RETURN_IF_ERROR(StartChild(i));
  Publish();
  return absl::OkStatus();
}

absl::Status Launcher::StartChild(std::size_t index) {
  const HouseProcess& process = plan_.processes[index];
  Child& child = children_[index];
  std::error_code ignored;
  if (!process.port_file.empty()) std::filesystem::remove(process.port_file, ignored);
  std::vector<std::string> environment = {
      absl::StrCat("MORTISE_LOG_FILE=", LogOf(index).string()),
      absl::StrCat("MORTISE_LOG_MEGABYTES=", options_.log_megabytes)};
  // Workers share the cores; each solves on one of them.
  if (process.address.empty()) environment.push_back("OPENBLAS_NUM_THREADS=1");
  MORTISE_ASSIGN_OR_RETURN(child.pid, StartProcess(process.command, LogOf(index), environment));
  child.started = Clock::now();
  child.serving = false;
  return absl::OkStatus();
}

bool Launcher::ChildServes(std::size_t index) const {
  const HouseProcess& process = plan_.processes[index];
  // A process without a port of its own serves as soon as it runs.
  if (process.port_file.empty()) return true;
  std::error_code ignored;
  return std::filesystem::exists(process.port_file, ignored);
}

absl::Status Launcher::NoticeDeath(std::size_t index, const std::string& how) {
  Child& child = children_[index];
  const std::string& name = plan_.processes[index].name;
  Log(LogLevel::kWarning, "a process ended", {{"process", name}, {"how", how}});
  if (child.serving && Clock::now() - child.started > kLongEnoughToForgive) child.back_off = {};
  child.deaths_before_serving = child.serving ? 0 : child.deaths_before_serving + 1;
  child.pid = 0;
  child.serving = false;
  if (child.deaths_before_serving >= kDeathsBeforeGivingUp) {
    return PreconditionFailed(
        "PROCESS_KEEPS_DYING",
        absl::StrCat(name, " ended ", kDeathsBeforeGivingUp, " times before it served (", how,
                     "). The end of ", LogOf(index).string(), ":\n", LastLines(LogOf(index))),
        name);
  }
  child.start_again = Clock::now() + child.back_off;
  child.back_off = std::clamp<Clock::duration>(child.back_off * 2, kFirstBackOff, kMaxBackOff);
  return absl::OkStatus();
}

absl::Status Launcher::Supervise() {
  bool news = false;
  for (std::size_t i = 0; i < children_.size(); ++i) {
    Child& child = children_[i];
    if (child.pid != 0) {
      if (const auto end = CollectProcess(child.pid)) {
        news = true;
        MORTISE_RETURN_IF_ERROR(NoticeDeath(i, end->ToString()));
      }
    }
    if (child.pid == 0 && Clock::now() >= child.start_again) {
      news = true;
      ++child.restarts;
      MORTISE_RETURN_IF_ERROR(StartChild(i));
    }
    if (child.pid != 0 && !child.serving && ChildServes(i)) {
      news = true;
      child.serving = true;
    }
  }
  if (news) Publish();
  return absl::OkStatus();
}

bool Launcher::Serving() const {
  return std::all_of(children_.begin(), children_.end(), [](const Child& c) { return c.serving; });
}

std::vector<std::string> Launcher::Starting() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < children_.size(); ++i) {
    if (!children_[i].serving) names.push_back(plan_.processes[i].name);
  }
  return names;
}

std::int64_t Launcher::StartProgress() const {
  constexpr std::int64_t kServing = std::int64_t{1} << 40;  // more than any time of processors
  std::int64_t progress = 0;
  for (const Child& child : children_) {
    progress += child.serving ? kServing : child.pid == 0 ? 0 : ProcessorTicks(child.pid);
  }
  return progress;
}

void Launcher::Publish() {
  house_.launcher = ::getpid();
  house_.gateway_grpc = plan_.gateway_grpc;
  house_.gateway_http = plan_.gateway_http;
  house_.plain_text = options_.insecure_development;
  const std::string authority = AuthorityOf(options_);
  house_.authority = authority.empty() ? "" : std::filesystem::absolute(authority).string();
  house_.processes.clear();
  for (std::size_t i = 0; i < children_.size(); ++i) {
    house_.processes.push_back({plan_.processes[i].name, children_[i].pid,
                                plan_.processes[i].address, children_[i].restarts,
                                children_[i].serving});
  }
  if (const absl::Status status = WriteRunningHouse(options_.state, house_); !status.ok()) {
    Log(LogLevel::kError, "cannot write house.json", {{"error", status.message()}});
  }
  changed_(house_);
}

void Launcher::Stop(milliseconds patience, const std::function<bool()>& hurry) {
  for (const Child& child : children_) {
    if (child.pid != 0) ::kill(child.pid, SIGTERM);
  }
  const Clock::time_point deadline = Clock::now() + patience;
  const auto running = [this] {
    bool any = false;
    for (Child& child : children_) {
      if (child.pid != 0 && CollectProcess(child.pid)) child.pid = 0;
      any = any || child.pid != 0;
    }
    return any;
  };
  while (running()) {
    if (hurry() || Clock::now() > deadline) {
      for (const Child& child : children_) {
        if (child.pid != 0) ::kill(child.pid, SIGKILL);
      }
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
}

std::filesystem::path Launcher::LogOf(std::size_t index) const {
  return options_.state / "logs" / (plan_.processes[index].name + ".log");
}

}  // namespace mortise::cli
