// Streams of the probe service, through a real server.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {

// Lets one thread wait for what another has done.
class Signal {
 public:
  void Set() {
    std::lock_guard lock(mutex_);
    set_ = true;
    changed_.notify_all();
  }
  bool Wait() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return set_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool set_ = false;
};

inline ReadResponse Number(int64_t number) {
  ReadResponse response;
  response.set_number(number);
  return response;
}

class StreamTest : public ProbeServerTest {
 protected:
  struct Received {
    std::vector<int64_t> numbers;
    absl::Status status;
  };

  Received Follow(const ReadRequest& request = {}) {
    auto context = Context(rpc::Role::kViewer);
    auto reader = stub_->Follow(context.get(), request);
    Received received;
    ReadResponse response;
    while (reader->Read(&response)) received.numbers.push_back(response.number());
    received.status = rpc::FromGrpc(reader->Finish());
    return received;
  }
};

}  // namespace mortise::testing
