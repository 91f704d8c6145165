#include "tests/integration/deploy/slurm/slurm_cluster.h"

#include <poll.h>
#include <pwd.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <stdexcept>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/e2e/command.h"

namespace mortise::testing {
namespace {

// Nothing but loopback is listened on. Jobs run wherever the kernel likes, as two nodes share one
// machine. KillWait is how long a job may take to end once it was asked to. A node that is down
// stays so until it is resumed.
constexpr char kConfiguration[] = R"(ClusterName=mortise
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=CONTROLLER_PORT
SlurmUser=USER
SlurmdUser=USER
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthType=auth/munge
AuthInfo=socket=FOLDER/munge.socket
CredType=cred/munge
StateSaveLocation=FOLDER/controller
SlurmctldPidFile=FOLDER/controller/pid
SlurmdSpoolDir=FOLDER/%n
SlurmdPidFile=FOLDER/%n/pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=batch_sched_delay=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MailProg=/bin/true
MpiDefault=none
SlurmdParameters=config_overrides
ReturnToService=0
KillWait=10
NodeName=node1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=NODE1_PORT CPUs=1 RealMemory=4096
NodeName=node2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=NODE2_PORT CPUs=1 RealMemory=4096
PartitionName=work Nodes=node1,node2 Default=YES MaxTime=INFINITE
)";

std::string UserName() {
  const passwd* const user = ::getpwuid(::geteuid());
  return user == nullptr ? absl::StrCat(::geteuid()) : user->pw_name;
}

// Only its owner may read it; 128 random bytes.
void WriteMungeKey(const std::filesystem::path& path) {
  std::random_device random;
  std::ofstream file(path, std::ios::binary);
  std::filesystem::permissions(
      path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  for (int i = 0; i < 128; ++i) file.put(static_cast<char>(random()));
}

}  // namespace

SlurmCluster::SlurmCluster() {
  const std::filesystem::path& folder = folder_.path();
  // Munge's clients must be able to reach its socket, as any user.
  std::filesystem::permissions(folder, std::filesystem::perms(0755));
  for (const char* name : {"controller", "node1", "node2"}) {
    std::filesystem::create_directory(folder / name);
  }
  WriteMungeKey(folder / "munge.key");
  WriteConfiguration();
  munge_ = std::make_unique<ChildProcess>(std::vector<std::string>{
      "/usr/sbin/munged", "--foreground", "--key-file=" + (folder / "munge.key").string(),
      "--socket=" + (folder / "munge.socket").string(),
      "--pid-file=" + (folder / "munge.pid").string(),
      "--seed-file=" + (folder / "munge.seed").string()});
  munge_->AwaitFile(folder / "munge.pid");
  controller_ = std::make_unique<ChildProcess>(
      std::vector<std::string>{"/usr/sbin/slurmctld", "-D", "-f", configuration()});
  for (const char* name : {"node1", "node2"}) {
    nodes_.push_back(std::make_unique<ChildProcess>(
        std::vector<std::string>{"/usr/sbin/slurmd", "-D", "-f", configuration(), "-N", name}));
  }
  const bool ready = Await([this] {
    const std::string idle = Output("sinfo --noheader --Node --states=idle --format=%N");
    return std::count(idle.begin(), idle.end(), '\n') == 2;
  });
  if (!ready) throw std::runtime_error("the nodes do not come up: " + controller_->Output());
}

SlurmCluster::~SlurmCluster() {
  Output("scancel --user=" + UserName());
  Await([this] { return Output("squeue --noheader").empty(); });
  for (const auto& node : nodes_) node->End(SIGTERM);
  controller_->End(SIGTERM);
  munge_->End(SIGTERM);
}

void SlurmCluster::WriteConfiguration() const {
  std::ofstream(configuration()) << absl::StrReplaceAll(
      kConfiguration, {{"USER", UserName()},
                       {"FOLDER", folder_.path().string()},
                       {"CONTROLLER_PORT", controller_port_.port()},
                       {"NODE1_PORT", node_ports_[0].port()},
                       {"NODE2_PORT", node_ports_[1].port()}});
}

std::string SlurmCluster::Output(const std::string& command) const {
  return e2e::Shell("SLURM_CONF=" + configuration() + " " + command, folder_.path()).out;
}

bool SlurmCluster::ControllerEnds(absl::Duration patience) const {
  pollfd end{.fd = controller_->end_descriptor(), .events = POLLIN, .revents = 0};
  return ::poll(&end, 1, static_cast<int>(absl::ToInt64Milliseconds(patience))) > 0;
}

}  // namespace mortise::testing
