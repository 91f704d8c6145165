// Processes, files and certificates of the benchmark.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace mortise::gateway {

// A child process; ends with this object.
class BenchProcess {
 public:
  explicit BenchProcess(const std::vector<std::string>& command);
  ~BenchProcess();
  BenchProcess(const BenchProcess&) = delete;
  BenchProcess& operator=(const BenchProcess&) = delete;

  // The next line of its standard output.
  std::string ReadLine();

  pid_t pid() const { return pid_; }

  // Resident memory now, bytes.
  int64_t ResidentBytes() const;

  // Seconds of processor time used so far.
  double ProcessorSeconds() const;

 private:
  pid_t pid_ = -1;
  int input_ = -1;
  int output_ = -1;
};

// A self-signed certificate for "localhost" and its key, as PEM files.
void WriteCertificate(const std::string& certificate, const std::string& key);

// A key pair for tokens: the public key as a PEM file, and a token of an admin signed with it.
std::string WriteTokenKey(const std::string& public_key);

}  // namespace mortise::gateway
