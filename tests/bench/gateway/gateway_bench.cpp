// What the gateway costs: calls, latency and streams through it against the same directly, on
// loopback, in plain text and over TLS with tokens and signed identities.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/files.h"
#include "common/rpc/identity.h"
#include "tests/bench/gateway/bench_load.h"
#include "tests/bench/gateway/bench_processes.h"
#include "tests/bench/gateway/bench_service.h"
#include "tests/support/temporary_folder.h"

namespace mortise::gateway {
namespace {

constexpr int kClients = 16;
constexpr int64_t kStreamBytes = 100'000'000;

struct Files {
  explicit Files(const std::filesystem::path& folder)
      : certificate(folder / "certificate.pem"),
        key(folder / "key.pem"),
        tokens(folder / "tokens.pem"),
        keys(folder / "keys"),
        ports(folder / "ports.json"),
        store(folder / "gateway.db"),
        log(folder / "gateway.log") {}
  std::string certificate, key, tokens, keys, ports, store, log;
};

std::string GatewayProgram(const char* self) {
  if (const char* folder = std::getenv("MORTISE_BIN_DIR")) {
    return std::string(folder) + "/mortise-gateway";
  }
  return (std::filesystem::path(self).parent_path() / "../bin/mortise-gateway").string();
}

std::string WaitForAddress(const Files& files) {
  for (int i = 0; i < 500; ++i) {
    const auto text = ReadFile(files.ports);
    if (text.ok()) return nlohmann::json::parse(*text)["grpc"];
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::fprintf(stderr, "the gateway did not start; see its messages above\n");
  std::exit(1);
}

// The ratio of the medians of several rounds, taken in turn, because the machine is not alone.
double MedianRatio(const BenchTarget& direct, const BenchTarget& through, double* direct_rate,
                   double* through_rate) {
  std::vector<double> ratios;
  for (int round = 0; round < 5; ++round) {
    const double a = MeasureCallRate(direct, 2);
    const double b = MeasureCallRate(through, 2);
    ratios.push_back(b / a);
    *direct_rate = std::max(*direct_rate, a);
    *through_rate = std::max(*through_rate, b);
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios[ratios.size() / 2];
}

void Measure(const char* title, const BenchTarget& direct, const BenchTarget& through,
             const BenchProcess& gateway) {
  double direct_rate = 0;
  double through_rate = 0;
  const double ratio = MedianRatio(direct, through, &direct_rate, &through_rate);
  std::printf("%s, %d clients\n", title, kClients);
  std::printf("  unary calls/s      direct %8.0f   gateway %8.0f   ratio %.2f  (target 0.33)\n",
              direct_rate, through_rate, ratio);
  const double load = through_rate / 5;
  std::vector<double> added;
  double direct_p99 = 0;
  double through_p99 = 0;
  for (int round = 0; round < 5; ++round) {
    direct_p99 = MeasureP99(direct, load, 2);
    through_p99 = MeasureP99(through, load, 2);
    added.push_back(through_p99 - direct_p99);
  }
  std::sort(added.begin(), added.end());
  std::printf(
      "  p99 at %5.0f/s      direct %6.2f ms   gateway %6.2f ms   added %.2f ms  "
      "(target 1 ms)\n",
      load, direct_p99 * 1e3, through_p99 * 1e3, added[added.size() / 2] * 1e3);
  const int64_t before = gateway.ResidentBytes();
  int64_t most = before;
  double direct_bytes = 0;
  double through_bytes = 0;
  for (int round = 0; round < 3; ++round) {
    direct_bytes = std::max(direct_bytes, MeasureStreamRate(direct, kStreamBytes, [] {}));
    through_bytes = std::max(through_bytes, MeasureStreamRate(through, kStreamBytes, [&] {
                               most = std::max(most, gateway.ResidentBytes());
                             }));
  }
  std::printf("  100 MB stream MB/s direct %8.0f   gateway %8.0f   ratio %.2f  (target 0.25)\n",
              direct_bytes / 1e6, through_bytes / 1e6, through_bytes / direct_bytes);
  std::printf("  gateway memory     %.1f MiB, grew by %.1f MiB  (target 32 MiB)\n",
              static_cast<double>(before) / (1 << 20),
              static_cast<double>(most - before) / (1 << 20));
}

int Run(const char* self) {
  const mortise::testing::TemporaryFolder folder;
  const Files files(folder.path());
  WriteCertificate(files.certificate, files.key);
  const std::string token = WriteTokenKey(files.tokens);
  const absl::Status keys = rpc::CreateIdentityKey(files.keys, "gateway");
  if (!keys.ok()) std::fprintf(stderr, "%s\n", std::string(keys.message()).c_str());
  const std::string authority = ReadFile(files.certificate).value_or("");

  BenchProcess service({self, "--service", files.certificate, files.key});
  const std::string line = service.ReadLine();
  const std::string plain = line.substr(0, line.find(' '));
  const std::string secure = line.substr(line.find(' ') + 1);
  const std::vector<std::string> common = {
      GatewayProgram(self),    "--service",   "catalog=" + plain, "--store",
      "sqlite:" + files.store, "--port-file", files.ports};
  // Call lines are part of the price; they go where a log collector would read them.
  if (std::freopen(files.log.c_str(), "w", stderr) == nullptr) return 1;
  {
    std::vector<std::string> command = common;
    command.push_back("--insecure-development");
    const BenchProcess gateway(command);
    const std::string address = WaitForAddress(files);
    Measure("Plain text", MakeTarget(plain, kClients, "", ""),
            MakeTarget(address, kClients, "", ""), gateway);
  }
  std::filesystem::remove(files.ports);
  std::vector<std::string> command = common;
  command.insert(command.end(), {"--keys", files.keys, "--jwt-keys", files.tokens,
                                 "--tls-certificate", files.certificate, "--tls-key", files.key});
  const BenchProcess gateway(command);
  const std::string address = WaitForAddress(files);
  Measure("TLS, tokens, signed identities", MakeTarget(secure, kClients, authority, ""),
          MakeTarget(address, kClients, authority, token), gateway);
  return 0;
}

}  // namespace
}  // namespace mortise::gateway

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "--service") {
    return mortise::gateway::RunBenchService(argv[2], argv[3]);
  }
  return mortise::gateway::Run(argv[0]);
}
