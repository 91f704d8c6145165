// Learns of a parameter from designs that differ in it alone.
//
// A *line* is four evaluated designs or more, all feasible, that are alike but for one parameter,
// in which neighbours are a hundredth of its range apart or more. Looking along the parameters one
// by one (coordinate_descent.h) leaves some behind.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

struct ParameterLine {
  Eigen::Index parameter = 0;
  std::vector<std::size_t> entries;  // of the archive, ascending in the parameter
};

// Returns all lines of an archive. O(n D log n) for n entries.
std::vector<ParameterLine> ParameterLines(const Archive& archive);

// Returns the parameters that trade metrics off, strongest first. A parameter's strength is the
// second largest range of a metric, in units of `scaling`, among those designs of one of its lines
// that do not dominate each other; a strength below `least` does not count.
std::vector<Eigen::Index> TradingParameters(const Archive& archive,
                                            const std::vector<ParameterLine>& lines,
                                            const Scaling& scaling, double least);

// Returns how far designs may differ in each parameter (D) for metrics to change by about as much
// that no parabola explains, relative to the parameter with the longest such length: 1 but for
// parameters along which metrics ripple, whose length is half of that or less (0.05 at least). It
// is found by how far values are from parabolas through their neighbours on a line, in the median.
// Metrics that range over a tenth of `scaling` on the line count. A parameter that no line tells of
// has 1.
Eigen::VectorXd RelativeLengths(const Archive& archive, const std::vector<ParameterLine>& lines,
                                const Scaling& scaling);

// Returns a design for each metric. Each parameter is where that metric is least on the parameter's
// line with most designs, or, if it has no line, as the best entry has it. Returns nothing without
// lines. For metrics that are sums over parameters, or a function of such a sum, it is in the
// valley of their optimum, however many others there are.
std::vector<Eigen::VectorXd> LeastAlongLines(const Archive& archive,
                                             const std::vector<ParameterLine>& lines);

}  // namespace mortise::pareto
