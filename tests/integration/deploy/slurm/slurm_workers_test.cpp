// deploy/slurm on a real Slurm cluster: workers that reach a house with TLS and tokens through its
// gateway do its tasks on both nodes, and lose none when they are cancelled, when their time is
// over, or when their node fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "common/base/files.h"
#include "tests/e2e/command.h"
#include "tests/e2e/manual/manual.h"
#include "tests/integration/deploy/slurm/slurm_cluster.h"

namespace mortise::testing {
namespace {

using Json = nlohmann::json;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::absolute(folder == nullptr ? "." : folder);
}

const std::string kSubmit =
    "deploy/slurm/submit --gateway 127.0.0.1:7700 --authority house.pem --token-file ada.token ";

// In place of the program, on the PATH: notes what it was given, and cannot outlive a test that was
// killed for longer than a few minutes.
constexpr char kProgram[] = R"(#!/bin/bash
env > "logs/environment-$SLURM_ARRAY_TASK_ID"
exec timeout --signal=KILL 290 PROGRAM "$@"
)";

// Gateway, catalog and simulator, without a worker. The gateway asks for tokens and TLS.
class House {
 public:
  explicit House(const std::filesystem::path& folder) {
    const std::string keys = "--keys=" + (folder / "keys").string();
    const auto store = [&folder](const std::string& name) {
      return "--store=sqlite:" + (folder / (name + ".db")).string();
    };
    const auto start = [&](const std::string& name, std::vector<std::string> flags) {
      flags.insert(flags.end(), {keys, store(name), "--log-level=warning"});
      return std::make_unique<ServiceProcess>(BuiltProgram("mortise-" + name), flags,
                                              folder / (name + ".json"));
    };
    catalog_ = start("catalog", {"--blobs=" + (folder / "catalog-blobs").string(),
                                 "--collection=" + (Source() / "collection").string()});
    const std::string catalog = "catalog=" + catalog_->address();
    simulator_ = start("simulator",
                       {"--blobs=" + (folder / "simulator-blobs").string(), "--peer=" + catalog});
    gateway_ = start("gateway", {"--grpc=127.0.0.1:0", "--http=127.0.0.1:0", "--service=" + catalog,
                                 "--service=simulator=" + simulator_->address(),
                                 "--jwt-keys=" + (folder / "tokens.pem").string(),
                                 "--tls-certificate=" + (folder / "house.pem").string(),
                                 "--tls-key=" + (folder / "house.key").string()});
  }

  const std::string& gateway() const { return gateway_->address(); }

 private:
  std::unique_ptr<ServiceProcess> catalog_;
  std::unique_ptr<ServiceProcess> simulator_;
  std::unique_ptr<ServiceProcess> gateway_;
};

class SlurmWorkersTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::filesystem::path& folder = folder_->path();
    std::filesystem::create_directory(folder / "logs");
    std::filesystem::create_directory(folder / "bin");
    std::filesystem::create_symlink(Source() / "deploy", folder / "deploy");
    const std::filesystem::path program = folder / "bin" / "mortise-simulator";
    const auto real = std::filesystem::absolute(BuiltProgram("mortise-simulator"));
    ASSERT_TRUE(
        WriteFile(program, absl::StrReplaceAll(kProgram, {{"PROGRAM", real.string()}})).ok());
    std::filesystem::permissions(program, std::filesystem::perms(0755));
    // Certificates and tokens as docs/gateway.md makes them.
    std::string preparation;
    for (const e2e::ManualBlock& block : e2e::ReadManual("docs/gateway.md")) {
      if (absl::StartsWith(block.text, "mortise up")) break;
      if (block.mark == "secure-house") preparation += block.text;
    }
    const e2e::CommandResult prepared = e2e::Shell(
        preparation + "token vera viewer 3600 > vera.token\nmortise keys keys\n", folder);
    ASSERT_EQ(prepared.exit_code, 0) << prepared.error;
    house_ = std::make_unique<House>(folder);
    cluster_ = std::make_unique<SlurmCluster>();
  }

  static void TearDownTestSuite() {
    cluster_.reset();
    house_.reset();
    folder_.reset();
  }

  void SetUp() override { ASSERT_NE(cluster_, nullptr); }

  // The jobs of a test end with it, so that the next one has both nodes.
  void TearDown() override {
    Output("scancel --name=mortise-worker");
    EXPECT_TRUE(cluster_->Await([] { return Output("squeue --noheader").empty(); }));
    for (const auto& entry : std::filesystem::directory_iterator(Logs())) {
      if (HasFailure() && entry.path().extension() == ".log") {
        std::cerr << "--- " << entry.path() << "\n" << ReadFile(entry.path()).value_or("");
      }
      std::filesystem::remove(entry.path());
    }
  }

  static std::filesystem::path Logs() { return folder_->path() / "logs"; }

  // Runs shell in the test's folder as somebody would who has Slurm and Mortise at hand.
  static e2e::CommandResult Run(const std::string& script) {
    return e2e::Shell("export SLURM_CONF=" + cluster_->configuration() +
                          " PATH=\"$PWD/bin:$PATH\"\n" +
                          absl::StrReplaceAll(script, {{"127.0.0.1:7700", house_->gateway()}}),
                      folder_->path());
  }

  static std::string Output(const std::string& script) {
    const e2e::CommandResult result = Run(script);
    EXPECT_EQ(result.exit_code, 0) << script << "\n" << result.error;
    return result.out;
  }

  // Submits workers; the number of their job, as `submit` tells it.
  static std::string Submit(const std::string& options) {
    return JobIn(Output(kSubmit + "--memory 1 --logs logs " + options));
  }

  static std::string JobIn(const std::string& told) {
    const std::size_t begin = told.find("job ") + 4;
    return told.substr(begin, told.find(':') - begin);
  }

  // A method called through the gateway.
  static Json Call(const std::string& method, const Json& request) {
    const std::string out = Output(
        "mortise --json --gateway 127.0.0.1:7700 --authority house.pem --token-file "
        "ada.token call --seconds 300 " +
        method + " '" + request.dump() + "'");
    return Json::parse(out, nullptr, false);
  }

  // What one worker has logged with this message.
  static std::vector<Json> Logged(const std::string& job, int task, const std::string& message) {
    const auto log = Logs() / absl::StrCat("mortise-worker-", job, "_", task, ".log");
    std::istringstream lines(ReadFile(log).value_or(""));
    std::vector<Json> found;
    for (std::string line; std::getline(lines, line);) {
      const Json entry = Json::parse(line, nullptr, false);
      if (entry.is_object() && entry.value("message", "") == message) found.push_back(entry);
    }
    return found;
  }

  // The same, once there are `count` of them.
  static std::vector<Json> AwaitLogged(const std::string& job, int task, const std::string& message,
                                       std::size_t count = 1) {
    EXPECT_TRUE(WaitForFiles(
        Logs(), [&] { return Logged(job, task, message).size() >= count; }, absl::Minutes(1)))
        << message;
    return Logged(job, task, message);
  }

  static std::string NameOfWorker(const std::string& job, int task) {
    const std::vector<Json> working = AwaitLogged(job, task, "working");
    return working.empty() ? "" : working.back()["worker"].get<std::string>();
  }

  // Tables of ever other lengths, so that no result is known already.
  static Json NewBatch(int size) {
    Json batch = {{"subject", "templates/table"},
                  {"metrics", {"mass", "max_displacement"}},
                  {"mesh", {{"element_size", 0.12}}}};
    for (int i = 0; i < size; ++i) {
      batch["points"].push_back(
          {{"parameters", {0.001 * next_length_++, 0.75, 0.74, 0.06, 0.09, 0.027}}});
    }
    return batch;
  }

  static Json StartAnalysis() {
    return Call("simulator.AnalyzeDesign",
                {{"template", "templates/table"},
                 {"parameters", {{{"name", "length"}, {"value", 0.001 * next_length_++}}}},
                 {"mesh", {{"element_size", 0.035}}}});
  }

  // The environment that a worker was started in.
  static std::map<std::string, std::string> Environment(int task) {
    std::istringstream lines(ReadFile(Logs() / absl::StrCat("environment-", task)).value_or(""));
    std::map<std::string, std::string> variables;
    for (std::string line; std::getline(lines, line);) {
      const std::size_t equals = line.find('=');
      if (equals != std::string::npos) variables[line.substr(0, equals)] = line.substr(equals + 1);
    }
    return variables;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static std::unique_ptr<House> house_;
  static std::unique_ptr<SlurmCluster> cluster_;
  static int next_length_;  // mm
};

std::unique_ptr<TemporaryFolder> SlurmWorkersTest::folder_;
std::unique_ptr<House> SlurmWorkersTest::house_;
std::unique_ptr<SlurmCluster> SlurmWorkersTest::cluster_;
int SlurmWorkersTest::next_length_ = 1000;

TEST_F(SlurmWorkersTest, WorkersOnBothNodesDoABatchAsTheManualSays) {
  std::string manual, told;
  for (const e2e::ManualBlock& block : e2e::ReadManual("docs/workers.md")) {
    if (block.mark == "slurm") manual += block.text;
  }
  told = Output(manual);
  ASSERT_THAT(told, HasSubstr("2 workers"));
  const std::string job = JobIn(told);
  EXPECT_THAT((std::set{NameOfWorker(job, 1), NameOfWorker(job, 2)}),
              ElementsAre(AnyOf("slurm-" + job + "_1.0@node1", "slurm-" + job + "_1.0@node2"),
                          AnyOf("slurm-" + job + "_2.0@node1", "slurm-" + job + "_2.0@node2")));
  EXPECT_NE(NameOfWorker(job, 1).back(), NameOfWorker(job, 2).back());

  constexpr int kBatch = 6;
  std::size_t asked = 0;
  const auto reported = [&job] {
    std::vector<Json> all = Logged(job, 1, "task reported");
    for (const Json& entry : Logged(job, 2, "task reported")) all.push_back(entry);
    return all;
  };
  // One batch is enough, unless one of the nodes was slow to come.
  for (int batch = 0; batch < 10; ++batch) {
    std::map<int, double> masses;
    for (const Json& result : Call("evaluator.EvaluateBatch", NewBatch(kBatch))) {
      ASSERT_FALSE(result.contains("error")) << result;
      EXPECT_FALSE(result["cached"].get<bool>());
      const bool is_new = masses.emplace(result["index"], result["metrics"][0]["value"]).second;
      EXPECT_TRUE(is_new) << "given twice: " << result;
    }
    ASSERT_EQ(masses.size(), static_cast<std::size_t>(kBatch));
    for (int i = 1; i < kBatch; ++i) EXPECT_GT(masses[i], masses[i - 1]) << "longer is heavier";
    asked += kBatch;
    ASSERT_TRUE(WaitForFiles(
        Logs(), [&] { return reported().size() >= asked; }, absl::Minutes(1)));
    if (!Logged(job, 1, "task reported").empty() && !Logged(job, 2, "task reported").empty()) break;
  }
  EXPECT_FALSE(Logged(job, 1, "task reported").empty());
  EXPECT_FALSE(Logged(job, 2, "task reported").empty());
  std::set<std::string> tasks;
  for (const Json& entry : reported()) {
    EXPECT_TRUE(tasks.insert(entry["task"]).second) << "done twice: " << entry;
  }
  EXPECT_EQ(tasks.size(), asked);
}

TEST_F(SlurmWorkersTest, CancelledWorkerGivesItsTaskBackAndAnotherDoesIt) {
  const std::string job = Submit("--workers 3 --drain-seconds 0");  // the third waits for a node
  NameOfWorker(job, 1);
  NameOfWorker(job, 2);
  const std::vector<Json> operations = {StartAnalysis(), StartAnalysis()};
  ASSERT_TRUE(cluster_->Await([] {
    const Json status = Call("simulator.GetQueueStatus", Json::object());
    return std::stoi(status["leased"].get<std::string>()) == 2;
  }));
  std::string given;
  const Json leased = Call("simulator.ListTasks", {{"state", "LEASED"}});
  for (const Json& entry : leased["tasks"]) {
    if (entry["task"]["worker"] == NameOfWorker(job, 1)) given = entry["task"]["name"];
  }
  ASSERT_NE(given, "") << leased;
  Output("scancel " + job + "_1");
  const std::vector<Json> returned = AwaitLogged(job, 1, "task given back");
  ASSERT_EQ(returned.size(), 1u);
  EXPECT_EQ(returned[0]["task"], given);
  NameOfWorker(job, 3);
  for (const Json& operation : operations) {
    const Json done =
        Call("operation.WaitOperation", {{"name", operation["name"]}, {"timeout_seconds", 120}});
    EXPECT_EQ(done["state"], "SUCCEEDED") << done;
  }
  ASSERT_TRUE(WaitForFiles(
      Logs(),
      [&] {
        return Logged(job, 2, "task reported").size() + Logged(job, 3, "task reported").size() == 2;
      },
      absl::Minutes(1)));
  EXPECT_TRUE(Logged(job, 1, "task reported").empty());
  for (int task : {2, 3}) {
    for (const Json& entry : Logged(job, task, "task reported")) {
      EXPECT_EQ(entry["outcome"], "done");
      EXPECT_EQ(entry["attempt"], entry["task"] == given ? "2" : "1");
    }
  }
  const Json quarantined = Call("simulator.ListTasks", {{"state", "QUARANTINED"}});
  EXPECT_TRUE(quarantined["tasks"].empty()) << quarantined;
}

TEST_F(SlurmWorkersTest, WorkerEndsWellBeforeItsTimeIsOver) {
  const std::string job = Submit("--time 1");
  NameOfWorker(job, 1);
  AwaitLogged(job, 1, "asked to end, once the task at hand is finished or given back");
  ASSERT_TRUE(cluster_->Await([] { return Output("squeue --noheader").empty(); }));
  EXPECT_THAT(Output("scontrol show job " + job),
              AllOf(HasSubstr("JobState=COMPLETED"), HasSubstr("ExitCode=0:0")));
}

TEST_F(SlurmWorkersTest, WorkerComesBackWhenItsNodeHasFailed) {
  const std::string job = Submit("--workers 1");
  const std::string first = NameOfWorker(job, 1);
  const std::string node = first.substr(first.find('@') + 1);
  Output("scontrol update NodeName=" + node + " State=down Reason=failed");
  ASSERT_TRUE(cluster_->Await(
      [&] { return Output("squeue --noheader --format=%T --jobs=" + job) == "PENDING\n"; }));
  // Slurm lets a requeued job wait for two minutes.
  Output("scontrol update JobId=" + job + " StartTime=now");
  AwaitLogged(job, 1, "working", 2);
  EXPECT_EQ(NameOfWorker(job, 1), "slurm-" + job + "_1.1@" + (node == "node1" ? "node2" : "node1"));
  Output("scontrol update NodeName=" + node + " State=resume");
}

TEST_F(SlurmWorkersTest, JobHasTheLimitsOfItsWorkerAndNoSecrets) {
  const std::string job =
      JobIn(Output("export MORTISE_TOKEN=secret LICENSE_KEY=secret\n" + kSubmit +
                   "--memory 1 --logs logs --time 30 --task-seconds 3000"));
  NameOfWorker(job, 1);
  std::map<std::string, std::string> variables = Environment(1);
  EXPECT_EQ(variables["MORTISE_MEMORY_LIMIT"], "0.966");  // nine tenths of a GiB, in GB
  EXPECT_EQ(variables["MORTISE_SOLVER_THREADS"], "1");
  EXPECT_EQ(variables["OPENBLAS_NUM_THREADS"], "1");
  const int seconds = std::atoi(variables["MORTISE_TIME_LIMIT"].c_str());
  EXPECT_LE(seconds, 29 * 60);
  EXPECT_GT(seconds, 20 * 60);
  const std::string token = ReadFile(folder_->path() / "ada.token").value_or("");
  ASSERT_NE(token, "");
  for (const auto& [name, value] : variables) {
    EXPECT_THAT(value, AllOf(Not(HasSubstr(token)), Not(HasSubstr("secret")))) << name;
  }
  EXPECT_THAT(Output("scontrol --details show job " + job), Not(HasSubstr(token)));

  EXPECT_THAT(Output(kSubmit +
                     "--workers 9 --at-most 4 --cores 2 --partition work --account wood --dry-run"),
              AllOf(HasSubstr("--array=1-9%4 --cpus-per-task=2 --mem=4G --time=04:00:00"),
                    HasSubstr("--partition=work --account=wood")));
}

TEST_F(SlurmWorkersTest, SubmitSaysWhatIsWrong) {
  const std::string sound = kSubmit;
  const auto refusal = [](const std::string& command, int code) {
    const e2e::CommandResult result = Run(command);
    EXPECT_EQ(result.exit_code, code) << command << result.out;
    EXPECT_THAT(result.error, HasSubstr("submit: "));
    return result.error;
  };
  EXPECT_THAT(refusal("deploy/slurm/submit", 2), HasSubstr("--gateway HOST:PORT is missing"));
  EXPECT_THAT(refusal(sound + "--wrokers 2", 2), HasSubstr("'--wrokers'"));
  EXPECT_THAT(refusal(sound + "--workers", 2), HasSubstr("--workers needs a value"));
  EXPECT_THAT(refusal(sound + "--workers 0", 2), HasSubstr("--workers must be"));
  EXPECT_THAT(refusal(sound + "--memory 2G", 2), HasSubstr("--memory must be"));
  EXPECT_THAT(refusal(sound + "--logs nowhere", 1), HasSubstr("--logs"));
  EXPECT_THAT(refusal(sound + "--program nothing", 1), HasSubstr("there is no program"));
  EXPECT_THAT(refusal(sound + "--authority nothing.pem", 1), HasSubstr("nothing.pem"));
  EXPECT_THAT(refusal(sound + "--token-file no.token", 1), HasSubstr("no.token"));
  EXPECT_THAT(
      refusal("cp ada.token open.token; chmod 644 open.token\n" + sound + "--token-file open.token",
              1),
      HasSubstr("chmod 600"));
  EXPECT_THAT(refusal(sound + "--gateway 127.0.0.1:1", 1),
              HasSubstr("the gateway cannot be reached: mortise: 127.0.0.1:1:"));
  EXPECT_THAT(refusal(sound + "--token-file vera.token", 1),
              AllOf(HasSubstr("does not let workers in"), HasSubstr("PERMISSION_DENIED")));
  EXPECT_THAT(refusal(sound + "--time soon", 1), HasSubstr("Slurm has refused the job"));
  // A PATH with all that is on it but Slurm's commands.
  EXPECT_THAT(refusal("mkdir -p plain; for name in bash realpath stat dirname mortise; do ln -sf "
                      "\"$(command -v $name)\" plain; done\n" +
                          absl::StrReplaceAll(sound, {{"deploy/", "PATH=plain deploy/"}}) +
                          "--program bin/mortise-simulator",
                      1),
              HasSubstr("there is no sbatch"));
}

}  // namespace
}  // namespace mortise::testing
