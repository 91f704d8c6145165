// The bridge's line to the fabplanner: dials out through the gateway, announces the machines, takes
// cuts over and reports how they ended. This file and its .cpp alone know gRPC.
//
// A cut is acknowledged after it is in the journal; a report is repeated on every new line until
// the fabplanner says that it is stored. When the line is down for longer than `line_lost_after`,
// cuts under way end and no others begin until the fabplanner says Resume.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "common/rpc/channel_security.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/work_order_runner.h"

namespace mortise::hwbridge {

class BridgeClient {
 public:
  struct Options {
    std::string bridge;                // name of this bridge, unique at the fabplanner
    std::string gateway;               // HOST:PORT
    rpc::ChannelSecurity security;     // TLS, or plain on loopback
    std::filesystem::path token_file;  // bearer token, read anew for each line; empty for none
    double line_lost_after = 10.0;     // s
    double state_period = 1.0;         // s between two announcements of the machines' states
    double first_delay = 0.1;          // s before the second try to attach; doubles
    double longest_delay = 3.0;        // s
    std::function<void()>
        on_attached;  // called each time the fabplanner has answered; may be empty
  };

  // Fails as rpc::MakeChannel does. `journal` must outlive the client.
  static absl::StatusOr<std::unique_ptr<BridgeClient>> Create(const Options& options,
                                                              Journal& journal);
  ~BridgeClient();

  // Keeps the line up until `stop` is requested.
  void Run(WorkOrderRunner& runner, std::stop_token stop);

  // Something to tell: a machine's state or a report. Thread safe.
  void NotifyChange();

 private:
  class Line;
  struct Shared;
  explicit BridgeClient(std::unique_ptr<Shared> shared);
  void WatchLine(WorkOrderRunner& runner, std::stop_token stop);

  std::unique_ptr<Shared> shared_;
};

}  // namespace mortise::hwbridge
