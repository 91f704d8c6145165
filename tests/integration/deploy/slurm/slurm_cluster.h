// A Slurm cluster for one test: a controller and two nodes of one processor each, all on loopback
// and as the user who runs the test, with munge between them. Their state is in a folder of its
// own.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/reserved_port.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

class SlurmCluster {
 public:
  // Starts the daemons of Debian's packages munge, slurmctld and slurmd, and waits until both
  // nodes, node1 and node2, take jobs. Throws std::runtime_error with what the controller said.
  SlurmCluster();
  // Ends all jobs, then the daemons.
  ~SlurmCluster();

  // What SLURM_CONF must be for Slurm's commands to speak with this cluster.
  std::string configuration() const { return (folder_.path() / "slurm.conf").string(); }

  // How long the cluster may take for what is waited for.
  static constexpr absl::Duration kPatience = absl::Seconds(60);

  // Asks until `holds()`, a few times a second; false after kPatience, or if the controller ends.
  template <class Holds>
  bool Await(const Holds& holds) const {
    const absl::Time end = absl::Now() + kPatience;
    while (!holds()) {
      if (absl::Now() > end || ControllerEnds(absl::Milliseconds(100))) return false;
    }
    return true;
  }

 private:
  void WriteConfiguration() const;
  std::string Output(const std::string& command) const;
  bool ControllerEnds(absl::Duration patience) const;

  TemporaryFolder folder_;
  const ReservedPort controller_port_;
  const ReservedPort node_ports_[2];
  std::unique_ptr<ChildProcess> munge_;
  std::unique_ptr<ChildProcess> controller_;
  std::vector<std::unique_ptr<ChildProcess>> nodes_;
};

}  // namespace mortise::testing
