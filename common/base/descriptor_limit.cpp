#include "common/base/descriptor_limit.h"

#include <sys/resource.h>

#include <algorithm>

namespace mortise {
namespace {

constexpr rlim_t kEnough = 65536;
constexpr int kReserve = 256;
// The part of the reserve that no connection may take even if others have been counted wrongly.
constexpr int kLast = 64;

int AsNumber(rlim_t limit) { return static_cast<int>(std::min<rlim_t>(limit, 1 << 30)); }

}  // namespace

int DescriptorLimit() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  return AsNumber(limit.rlim_cur);
}

int RaiseDescriptorLimit() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    const rlim_t wanted = std::min(limit.rlim_max, kEnough);
    if (wanted > limit.rlim_cur) {
      limit.rlim_cur = wanted;
      setrlimit(RLIMIT_NOFILE, &limit);
    }
  }
  return DescriptorLimit();
}

int ConnectionsWithin(int descriptor_limit) {
  return descriptor_limit - std::min(kReserve, descriptor_limit / 2);
}

bool IsAmongTheLast(int descriptor) {
  const int limit = DescriptorLimit();
  return descriptor >= limit - std::min(kLast, limit / 8);
}

}  // namespace mortise
