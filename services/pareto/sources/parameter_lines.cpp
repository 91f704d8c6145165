// FieldViolation lines, and the ranges and roughness of metrics along them.
#include "services/pareto/sources/parameter_lines.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "common/base/random.h"
#include "services/pareto/archive/non_dominated.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMinLine = 4;
constexpr double kMinGap = 0.01;        // between neighbours on a line
constexpr double kCountedRange = 0.1;   // of a metric on a line
constexpr double kSmooth = 0.1;         // deviation from parabolas, in ranges, at kSmoothGap
constexpr double kSmoothGap = 0.25;     // between neighbours
constexpr double kShortest = 0.05;      // relative length
constexpr double kCountedLength = 0.5;  // above, a few values do not tell lengths apart

std::uint64_t HashOf(Index i, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);  // one zero
  return Random(bits + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(i + 1)).Next();
}

bool AreAlikeBut(Index parameter, const VectorXd& a, const VectorXd& b) {
  for (Index i = 0; i < a.size(); ++i) {
    if (i != parameter && a[i] != b[i]) return false;
  }
  return true;
}

MatrixXd ScaledMetrics(const Archive& archive, const Scaling& scaling, const ParameterLine& line) {
  MatrixXd metrics(scaling.ideal.size(), std::ssize(line.entries));
  for (std::size_t k = 0; k < line.entries.size(); ++k) {
    metrics.col(static_cast<Index>(k)) = scaling.Apply(archive[line.entries[k]].metrics);
  }
  return metrics;
}

double Strength(const MatrixXd& metrics) {
  std::vector<VectorXd> points;
  for (const auto& point : metrics.colwise()) points.emplace_back(point);
  VectorXd least = VectorXd::Constant(metrics.rows(), std::numeric_limits<double>::infinity());
  VectorXd most = -least;
  for (const std::size_t k : NonDominated(points)) {
    least = least.cwiseMin(points[k]).eval();
    most = most.cwiseMax(points[k]).eval();
  }
  VectorXd ranges = most - least;
  std::ranges::sort(ranges, std::greater());
  return ranges[1];
}

// The cubic through four points is off the parabola through three of them in proportion to the
// third power of distances: how short a length makes a deviation what counts as smooth. The median
// tells of ripples all along; what has a kink or a steep end is smooth elsewhere.
double LengthAlong(const std::vector<double>& at, const VectorXd& values) {
  const Index count = values.size();
  const double range = values.maxCoeff() - values.minCoeff();
  std::vector<double> lengths;
  for (Index i = 1; i + 2 < count; ++i) {
    const auto x = [&](Index k) { return at[static_cast<std::size_t>(k)]; };
    const double ab = (values[i + 1] - values[i - 1]) / (x(i + 1) - x(i - 1));
    const double bc = (values[i + 2] - values[i + 1]) / (x(i + 2) - x(i + 1));
    const double curvature = (bc - ab) / (x(i + 2) - x(i - 1));
    const double told = values[i - 1] + (x(i) - x(i - 1)) * (ab + curvature * (x(i) - x(i + 1)));
    const double missed = std::clamp(std::abs(values[i] - told) / range, 1e-12, 1.0);
    const double gap = (x(i + 2) - x(i - 1)) / 3;
    lengths.push_back(gap / kSmoothGap * std::cbrt(kSmooth / missed));
  }
  const auto middle = lengths.begin() + std::ssize(lengths) / 2;
  std::ranges::nth_element(lengths, middle);
  return *middle;
}

}  // namespace

std::vector<ParameterLine> ParameterLines(const Archive& archive) {
  std::vector<ParameterLine> lines;
  if (archive.size() == 0) return lines;
  const Index size = archive[0].u.size();
  std::vector<std::uint64_t> whole(archive.size(), 0);
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    for (Index i = 0; i < size; ++i) whole[entry] += HashOf(i, archive[entry].u[i]);
  }
  for (Index i = 0; i < size; ++i) {
    std::vector<std::pair<std::uint64_t, std::size_t>> alike;  // but for parameter i, by hash
    for (std::size_t entry = 0; entry < archive.size(); ++entry) {
      if (archive[entry].feasible) {
        alike.emplace_back(whole[entry] - HashOf(i, archive[entry].u[i]), entry);
      }
    }
    std::ranges::sort(alike);
    for (auto first = alike.begin(), end = first; first != alike.end(); first = end) {
      end = std::find_if(first, alike.end(),
                         [&](const auto& each) { return each.first != first->first; });
      if (end - first < static_cast<std::ptrdiff_t>(kMinLine)) continue;
      std::vector<std::size_t> entries;
      for (const auto& [hash, entry] : std::ranges::subrange(first, end)) {
        if (AreAlikeBut(i, archive[entry].u, archive[first->second].u)) entries.push_back(entry);
      }
      const auto value = [&](std::size_t entry) { return archive[entry].u[i]; };
      std::ranges::stable_sort(entries, {}, value);
      std::vector<std::size_t> spaced;
      for (const std::size_t entry : entries) {
        if (spaced.empty() || value(entry) - value(spaced.back()) >= kMinGap) {
          spaced.push_back(entry);
        }
      }
      if (spaced.size() >= kMinLine) lines.push_back({i, std::move(spaced)});
    }
  }
  return lines;
}

std::vector<Index> TradingParameters(const Archive& archive,
                                     const std::vector<ParameterLine>& lines,
                                     const Scaling& scaling, double least) {
  if (scaling.ideal.size() < 2) return {};
  std::map<Index, double> strengths;
  for (const ParameterLine& line : lines) {
    double& strength = strengths[line.parameter];
    strength = std::max(strength, Strength(ScaledMetrics(archive, scaling, line)));
  }
  std::vector<std::pair<double, Index>> found;
  for (const auto& [parameter, strength] : strengths) {
    if (strength >= least) found.emplace_back(-strength, parameter);
  }
  std::ranges::sort(found);
  std::vector<Index> parameters;
  for (const auto& [strength, parameter] : found) parameters.push_back(parameter);
  return parameters;
}

VectorXd RelativeLengths(const Archive& archive, const std::vector<ParameterLine>& lines,
                         const Scaling& scaling) {
  VectorXd lengths =
      VectorXd::Constant(archive[0].u.size(), std::numeric_limits<double>::infinity());
  for (const ParameterLine& line : lines) {
    std::vector<double> at;
    for (const std::size_t entry : line.entries) at.push_back(archive[entry].u[line.parameter]);
    const MatrixXd metrics = ScaledMetrics(archive, scaling, line);
    for (const auto& values : metrics.rowwise()) {
      if (!(values.maxCoeff() - values.minCoeff() > kCountedRange)) continue;
      double& length = lengths[line.parameter];
      length = std::min(length, std::min(1.0, LengthAlong(at, values.transpose())));
    }
  }
  // Nothing is known against the others.
  lengths = lengths.cwiseMin(1.0).eval();
  lengths /= lengths.maxCoeff();
  return (lengths.array() > kCountedLength).select(1.0, lengths.array()).cwiseMax(kShortest);
}

std::vector<VectorXd> LeastAlongLines(const Archive& archive,
                                      const std::vector<ParameterLine>& lines) {
  std::map<Index, const ParameterLine*> longest;
  for (const ParameterLine& line : lines) {
    const ParameterLine*& other = longest[line.parameter];
    if (other == nullptr || other->entries.size() < line.entries.size()) other = &line;
  }
  std::vector<VectorXd> designs;
  if (lines.empty()) return designs;
  for (Index metric = 0; metric < archive.WholeRange().size(); ++metric) {
    const auto value = [&](std::size_t entry) { return archive[entry].metrics[metric]; };
    VectorXd& u = designs.emplace_back(
        archive[*std::ranges::min_element(archive.non_dominated(), {}, value)].u);
    for (const auto& [parameter, line] : longest) {
      u[parameter] = archive[*std::ranges::min_element(line->entries, {}, value)].u[parameter];
    }
  }
  return designs;
}

}  // namespace mortise::pareto
