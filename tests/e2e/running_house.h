// A house, started for the tests of a suite, and what of it must not change.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "tests/e2e/command.h"

namespace mortise::e2e {

class RunningHouse {
 public:
  // Starts it in a fresh folder and waits until every process serves; `Serving` tells whether they
  // do.
  explicit RunningHouse(int workers = 1);
  // Ends it and removes the folder.
  ~RunningHouse();
  RunningHouse(const RunningHouse&) = delete;
  RunningHouse& operator=(const RunningHouse&) = delete;

  bool Serving() const;

  // host:port of the gateway's doors.
  std::string GrpcAddress() const;
  std::string HttpAddress() const;

  // Process ids by name: a process that died and was started again has another.
  std::map<std::string, pid_t> Processes() const;

  // What the launcher printed.
  std::string Log() const;

 private:
  std::string State() const;

  const std::filesystem::path folder_;
  std::unique_ptr<BackgroundCommand> command_;
};

}  // namespace mortise::e2e
