#include "services/interpolator/mapping/path_samples.h"

#include <algorithm>
#include <cmath>

namespace mortise::interpolator {
namespace {

constexpr double kNear = 0.01;  // of the gaps to the next samples

std::vector<double> SharesOf(const LayoutSurface& surface, int path) {
  const std::vector<int>& vertices = surface.path(path);
  std::vector<double> shares = {0};
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    shares.push_back(shares.back() +
                     (surface.Point(vertices[i + 1]) - surface.Point(vertices[i])).norm());
  }
  const double length = shares.back();
  for (double& share : shares) share /= length;
  shares.back() = 1;
  return shares;
}

double SmallerGap(const std::vector<double>& shares, std::size_t i) {
  return std::min(shares[i] - shares[i - 1], shares[i + 1] - shares[i]);
}

// Splits a path where it has no vertex yet.
void SplitAtSamples(LayoutSurface& surface, int path, const std::vector<CommonSample>& samples,
                    bool CommonSample::*is_there) {
  const std::vector<double> shares = SharesOf(surface, path);
  std::size_t next = 1;  // among `shares`, behind the sample
  double last = 0;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    if (samples[i].*is_there) {
      last = shares[next++];
      continue;
    }
    const double share = (samples[i].share - last) / (shares[next] - last);
    surface.SplitPath(path, static_cast<int>(i) - 1, share);
    last = samples[i].share;
  }
}

}  // namespace

std::vector<CommonSample> CommonSamples(const std::vector<double>& first,
                                        const std::vector<double>& second) {
  std::vector<CommonSample> samples = {{0, true, true}};
  std::size_t i = 1, k = 1;
  while (i + 1 < first.size() || k + 1 < second.size()) {
    const bool has_first = i + 1 < first.size(), has_second = k + 1 < second.size();
    if (has_first && has_second &&
        std::abs(first[i] - second[k]) <=
            kNear * std::min(SmallerGap(first, i), SmallerGap(second, k))) {
      samples.push_back({first[i++], true, true});
      ++k;
    } else if (!has_second || (has_first && first[i] < second[k])) {
      samples.push_back({first[i++], true, false});
    } else {
      samples.push_back({second[k++], false, true});
    }
  }
  samples.push_back({1, true, true});
  return samples;
}

void ShareSamples(LayoutSurface& source, LayoutSurface& target, int path) {
  const std::vector<CommonSample> samples =
      CommonSamples(SharesOf(source, path), SharesOf(target, path));
  SplitAtSamples(source, path, samples, &CommonSample::is_in_first);
  SplitAtSamples(target, path, samples, &CommonSample::is_in_second);
}

}  // namespace mortise::interpolator
