// Load on one address: as many calls as it answers, calls at a fixed rate, one long stream.
#pragma once

#include <grpcpp/channel.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mortise::gateway {

// Where calls go: one channel for each concurrent client, and the bearer token if one is needed.
struct BenchTarget {
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  std::string token;
};

// `authority` is the PEM certificate to trust; empty for plain text.
BenchTarget MakeTarget(const std::string& address, int clients, const std::string& authority,
                       const std::string& token);

// Unary calls answered in a second when every client calls again as soon as it is answered.
double MeasureCallRate(const BenchTarget& target, double seconds);

// The p99 of latencies, in seconds, at `rate` calls a second spread evenly over the clients.
double MeasureP99(const BenchTarget& target, double rate, double seconds);

// Bytes a second of one stream of `bytes`. `sample` is called now and then meanwhile.
double MeasureStreamRate(const BenchTarget& target, int64_t bytes,
                         const std::function<void()>& sample);

}  // namespace mortise::gateway
