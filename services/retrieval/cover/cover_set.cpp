// Pivots, and a scan of what they do not exclude.
#include "services/retrieval/cover/cover_set.h"

#include <algorithm>
#include <cmath>

namespace mortise::retrieval {
namespace {

constexpr double kRounding = 1e-9;  // of a distance between descriptors, so that none is lost to it

}  // namespace

CoverSet::Keys CoverSet::KeysOf(const Eigen::VectorXd& x) const {
  Keys keys{};
  for (std::size_t i = 0; i < std::min(kPivots, primitives_.size()); ++i) {
    keys[i] = (x - primitives_[i].center).norm();
  }
  return keys;
}

void CoverSet::Add(Primitive primitive) {
  cost_ += Cost(primitive);
  reaches_.push_back(LargestRadius(primitive));
  primitives_.push_back(std::move(primitive));
  if (primitives_.size() > kPivots) {
    keys_.push_back(KeysOf(primitives_.back().center));
    return;
  }
  keys_.clear();  // there is one more pivot
  for (const Primitive& each : primitives_) keys_.push_back(KeysOf(each.center));
}

bool CoverSet::Covers(const Eigen::VectorXd& x, int structure, double delta,
                      std::size_t from) const {
  const Keys keys = KeysOf(x);
  for (std::size_t i = from; i < primitives_.size(); ++i) {
    if (primitives_[i].structure != structure) continue;
    const double within = delta + reaches_[i];
    bool possible = true;
    for (std::size_t k = 0; k < kPivots && possible; ++k) {
      possible = std::abs(keys[k] - keys_[i][k]) <= within + kRounding * (within + keys[k]);
    }
    if (possible && Distance(primitives_[i], x) <= delta) return true;
  }
  return false;
}

}  // namespace mortise::retrieval
