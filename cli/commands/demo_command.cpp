// mortise demo: the main job from a parametric table to cut parts, as a row of commands that anyone
// can type after it.
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/ending_signals.h"
#include "cli/client/flag_checks.h"
#include "cli/client/session.h"
#include "cli/commands/command_line.h"
#include "cli/commands/commands.h"
#include "cli/launcher/state_folder.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/process.h"

namespace mortise::cli {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

// More than `mortise up` itself has for its processes.
constexpr std::chrono::seconds kStartPatience{330};
constexpr std::chrono::milliseconds kLookEvery{20};

struct DemoOptions {
  std::filesystem::path out = "out/demo";
  int evaluations = 70;
  std::int64_t seed = 1;
  double time_scale = 30;
};

// Notices that somebody asks the demo to end, also between the commands it runs: its house ends
// with it.
class Asked {
 public:
  explicit Asked(Output& output)
      : signals_([this, &output](int signal, int count) {
          signal_ = signal;
          if (count == 1) return;
          output.Failure(status());
          ::_exit(128 + signal);  // the house gets SIGTERM as its parent ends
        }) {}

  absl::Status status() const {
    if (signal_ == 0) return absl::OkStatus();
    return Interrupted(signal_, "the demo was stopped, and its house with all that ran in it");
  }

 private:
  std::atomic<int> signal_ = 0;
  EndingSignals signals_;  // last: gone before what it sets
};

// A house of the demo's own, in a process of its own, stopped when the demo ends.
class DemoHouse {
 public:
  static absl::StatusOr<std::unique_ptr<DemoHouse>> Start(const DemoOptions& options,
                                                          const Asked& asked) {
    const std::filesystem::path state = options.out / "house";
    std::error_code ignored;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
    if (const auto old = ReadRunningHouse(state); old.ok() && ProcessExists(old->launcher)) {
      return PreconditionFailed("STATE_FOLDER_IN_USE",
                                absl::StrCat("a demo runs on ", state.string()), "--out");
    }
    std::filesystem::remove_all(state, ignored);
    std::vector<std::string> command = {
        self.string(),    "up",           "--insecure-development",
        "--virtual-cell", "--time-scale", absl::StrCat(options.time_scale),
        "--any-ports",    "--state",      state.string()};
    MORTISE_ASSIGN_OR_RETURN(const pid_t pid, StartProcess(command, options.out / "house.log"));
    auto house = std::unique_ptr<DemoHouse>(new DemoHouse(pid));
    const Clock::time_point deadline = Clock::now() + kStartPatience;
    while (true) {
      MORTISE_RETURN_IF_ERROR(asked.status());
      const absl::StatusOr<RunningHouse> running = ReadRunningHouse(state);
      if (running.ok() && !running->processes.empty() &&
          std::all_of(running->processes.begin(), running->processes.end(),
                      [](const RunningProcess& process) { return process.serving; })) {
        house->running_ = *running;
        return house;
      }
      const auto end = CollectProcess(pid);
      if (end || Clock::now() > deadline) {
        const std::string log = ReadFile(options.out / "house.log").value_or("");
        return absl::UnavailableError(absl::StrCat(
            "the house did not start: ", log.substr(log.size() > 2000 ? log.size() - 2000 : 0)));
      }
      std::this_thread::sleep_for(kLookEvery);
    }
  }

  ~DemoHouse() {
    ::kill(pid_, SIGTERM);
    while (!CollectProcess(pid_)) std::this_thread::sleep_for(kLookEvery);
  }
  DemoHouse(const DemoHouse&) = delete;
  DemoHouse& operator=(const DemoHouse&) = delete;

  const RunningHouse& running() const { return running_; }

 private:
  explicit DemoHouse(pid_t pid) : pid_(pid) {}
  const pid_t pid_;
  RunningHouse running_;
};

// How its commands are run.
struct DemoRun {
  const Session& session;
  const Asked& asked;
};

// Runs a command, and again for a while where a service is just starting anew. Not what releases
// work to machines: whether a lost answer stood for a release, only a person should say.
absl::Status RunThroughRestarts(const std::vector<std::string>& arguments, const DemoRun& run,
                                Output& output) {
  constexpr std::chrono::seconds kPatience{30};
  constexpr std::chrono::milliseconds kPause{200};
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    MORTISE_RETURN_IF_ERROR(run.asked.status());
    const absl::Status status = RunCommandLine(arguments, run.session, output);
    const bool again = absl::IsUnavailable(status) && arguments.front() != "fab" &&
                       std::chrono::steady_clock::now() < end;
    if (!again) return status;
    std::this_thread::sleep_for(kPause);
  }
}

// Shows a command, runs it, and returns the document it made.
absl::StatusOr<Json> Step(const std::string& what, const std::vector<std::string>& arguments,
                          const DemoRun& run, const Output& output) {
  output.Line(absl::StrCat("\n== ", what, "\n$ mortise ", absl::StrJoin(arguments, " ")));
  Output step(output.text() ? Output::Form::kText : Output::Form::kSilent);
  MORTISE_RETURN_IF_ERROR(RunThroughRestarts(arguments, run, step));
  return Json::parse(step.last_document(), nullptr, /*allow_exceptions=*/false);
}

// The same without a word.
absl::StatusOr<Json> Ask(const std::vector<std::string>& arguments, const DemoRun& run) {
  Output silent(Output::Form::kSilent);
  MORTISE_RETURN_IF_ERROR(RunThroughRestarts(arguments, run, silent));
  return Json::parse(silent.last_document(), nullptr, /*allow_exceptions=*/false);
}

// What a workshop can set: each parameter of the picked trade-off rounded to its step.
std::vector<std::string> RoundedParameters(const Json& picked, const Json& design_template) {
  std::vector<std::string> arguments;
  for (const Json& value : picked.at("parameters")) {
    double number = value.at("value").get<double>();
    for (const Json& parameter : design_template.at("parameters")) {
      const double step = parameter.at("step").get<double>();
      if (parameter.at("name") == value.at("name") && step > 0) {
        number = std::round(number / step) * step;
      }
    }
    arguments.push_back("--set");
    arguments.push_back(absl::StrFormat("%s=%.6g", value.at("name").get<std::string>(), number));
  }
  return arguments;
}

std::vector<std::string> With(std::vector<std::string> first,
                              const std::vector<std::string>& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

// One JSON object a line, as happened, all streams.
absl::Status WriteEventLog(const std::filesystem::path& path, const DemoRun& run) {
  MORTISE_ASSIGN_OR_RETURN(Json events, Ask({"events"}, run));
  std::stable_sort(events.begin(), events.end(), [](const Json& a, const Json& b) {
    return a.value("time", "") < b.value("time", "");
  });
  std::string lines;
  for (const Json& event : events) lines += event.dump() + "\n";
  return WriteFile(path, lines);
}

std::string Length(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(file, ignored);
  return ignored ? "missing" : absl::StrFormat("%.1f kB", static_cast<double>(size) / 1000);
}

void Summarise(const DemoOptions& options, const Json& front, const Json& analysis,
               const Json& plan, const Json& order, double seconds, Output& output) {
  Json files = Json::array();
  std::vector<std::vector<std::string>> rows;
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(options.out)) {
    if (entry.is_regular_file()) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const std::filesystem::path& path : paths) {
    rows.push_back({path.string(), Length(path)});
    files.push_back(path.string());
  }
  output.Line(absl::StrFormat(
      "\n== Done in %.0f s: %s trade-offs found, %s cuts made, %.2f %s of material", seconds,
      front.value("point_count", 0) == 0 ? "no" : absl::StrCat(front.value("point_count", 0)),
      absl::StrCat(order.value("cuts_done", 0)), plan.at("total").value("amount", 0.0),
      plan.at("total").value("currency", "")));
  output.Table({"file", "size"}, rows);
  output.Document({{"seconds", seconds},
                   {"front", front},
                   {"analysis", analysis},
                   {"plan", plan},
                   {"work_order", order},
                   {"files", files}});
}

absl::Status Demo(const DemoOptions& options, Output& output) {
  const Clock::time_point begin = Clock::now();
  const std::filesystem::path out = options.out;
  const Asked asked(output);
  MORTISE_ASSIGN_OR_RETURN(const auto house, DemoHouse::Start(options, asked));
  Session session;
  session.house_ends_too = true;
  session.gateway.address = house->running().gateway_grpc;
  const DemoRun run{session, asked};
  output.Line(absl::StrCat("A house runs on ", (out / "house").string(), ", its gateway on ",
                           session.gateway.address, "."));

  // The designer's wish: a table for a given room; what carries it is open.
  const std::vector<std::string> wish = {"--set",       "length=1500mm", "--set",
                                         "width=800mm", "--set",         "height=730mm"};
  MORTISE_RETURN_IF_ERROR(
      Step("Customise an expert's table", With({"catalog", "evaluate", "table"}, wish), run, output)
          .status());
  MORTISE_RETURN_IF_ERROR(
      Step("Check it by finite elements", With({"analyze", "table"}, wish), run, output).status());
  MORTISE_ASSIGN_OR_RETURN(
      const Json front,
      Step("Trade mass against deflection",
           {"pareto", "run", "table", "--minimize", "mass", "--minimize", "max_displacement",
            "--fix", "length=1500mm", "--fix", "width=800mm", "--fix", "height=730mm",
            "--evaluations", absl::StrCat(options.evaluations), "--seed",
            absl::StrCat(options.seed), "--out", out.string()},
           run, output));
  MORTISE_ASSIGN_OR_RETURN(
      const Json picked,
      Step("Pick a trade-off in the middle",
           {"pareto", "pick", front.at("name").get<std::string>(), "--at", "0.5"}, run, output));
  MORTISE_ASSIGN_OR_RETURN(const Json design, Ask({"catalog", "show", "table"}, run));
  const std::vector<std::string> chosen = RoundedParameters(picked, design);
  MORTISE_RETURN_IF_ERROR(
      Step("Take it in sizes a workshop can set",
           With({"catalog", "evaluate", "table", "--step", (out / "table.step").string(), "--glb",
                 (out / "table.glb").string()},
                chosen),
           run, output)
          .status());
  MORTISE_ASSIGN_OR_RETURN(
      const Json analysis,
      Step("Check what was taken", With({"analyze", "table", "--out", out.string()}, chosen), run,
           output));
  MORTISE_ASSIGN_OR_RETURN(
      const Json plan, Step("Plan its fabrication",
                            With({"plan", "table", "--out", out.string()}, chosen), run, output));
  MORTISE_ASSIGN_OR_RETURN(
      const Json order, Step("Cut it on two machines over Modbus",
                             {"fab", "release", plan.at("name").get<std::string>()}, run, output));
  MORTISE_RETURN_IF_ERROR(WriteEventLog(out / "events.jsonl", run));
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  Summarise(options, front, analysis, plan, order, seconds, output);
  return absl::OkStatus();
}

}  // namespace

void AddDemoCommand(CLI::App& app, Session& session) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* demo = app.add_subcommand("demo", "The main job, from a parametric table to cut parts");
  demo->add_option("--out", options->out, "Folder for what it makes")->capture_default_str();
  demo->add_option("--evaluations", options->evaluations, "Budget of the trade-off")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  demo->add_option("--seed", options->seed, "Seed of the trade-off")->capture_default_str();
  demo->add_option("--time-scale", options->time_scale, "Speed of the virtual machines")
      ->check(PositiveFinite())
      ->capture_default_str();
  demo->footer("Example: mortise demo --out out/demo");
  demo->callback([&session, options] {
    session.command = [options](Session&, Output& output) { return Demo(*options, output); };
  });
}

}  // namespace mortise::cli
