#include "services/simulator/service/difference_gradients.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

constexpr double kMinStep = 1e-6;
constexpr double kMaxStep = 0.1;
constexpr int kMaxDesigns = 20000;  // of a batch, with those beside its points

bool IsWhole(const v1::DesignSpace::DesignParameter& parameter) {
  return parameter.step() == 1 && parameter.minimum() == std::round(parameter.minimum());
}

}  // namespace

absl::Status CheckDifferences(const v1::EvaluateBatchRequest& asked, int parameters) {
  const double step = asked.difference_step();
  if (step == 0) return absl::OkStatus();
  if (!(step >= kMinStep && step <= kMaxStep)) {
    return InvalidField("difference_step", absl::StrCat("must be within ", kMinStep, " to ",
                                                        kMaxStep, ", or 0 for no differences"));
  }
  if (!asked.gradients()) {
    return InvalidField("difference_step", "is of gradients, which are not asked for");
  }
  const int most = std::max(1, kMaxDesigns / (1 + 2 * parameters));
  if (asked.points_size() <= most) return absl::OkStatus();
  return InvalidField("points",
                      absl::StrCat("must be up to ", most, " with differences of ", parameters,
                                   " parameters: ", kMaxDesigns, " designs in all"));
}

std::vector<DifferenceStencil> StencilsAround(const v1::DesignSpace& space,
                                              const v1::DesignPoint& point, double step) {
  std::vector<DifferenceStencil> stencils;
  for (int k = 0; k < space.parameters_size(); ++k) {
    const double below = point.parameters(k) - space.parameters(k).minimum();
    const double above = space.parameters(k).maximum() - point.parameters(k);
    double distance = step * (below + above);
    DifferenceStencil& stencil = stencils.emplace_back();
    // Nothing lies between two choices, and between whole numbers no number that designs have.
    if (!(distance > 0) || !space.parameters(k).choices().empty()) continue;
    if (IsWhole(space.parameters(k))) {
      distance = std::max(1.0, std::round(distance));
      if (std::max(below, above) < 2 * distance && std::min(below, above) < distance) continue;
    }
    if (below >= distance && above >= distance) {
      stencil.offsets = {-distance, distance};
    } else if (above > below) {
      stencil.offsets = {distance, 2 * distance};
    } else {
      stencil.offsets = {-distance, -2 * distance};
    }
  }
  return stencils;
}

v1::DesignPoint PointAtOffset(const v1::DesignSpace& space, const v1::DesignPoint& point,
                              int parameter, double offset) {
  v1::DesignPoint beside = point;
  const v1::DesignSpace::DesignParameter& range = space.parameters(parameter);
  beside.set_parameters(parameter, std::clamp(point.parameters(parameter) + offset, range.minimum(),
                                              range.maximum()));
  return beside;
}

std::optional<double> SlopeAt(double at, const DifferenceStencil& stencil,
                              const std::array<std::optional<double>, 2>& values) {
  if (stencil.IsEmpty()) return 0;
  const auto [a, b] = stencil.offsets;
  const auto& [of_a, of_b] = values;
  if (of_a && of_b) return ((*of_a - at) * b / a - (*of_b - at) * a / b) / (b - a);
  if (of_a) return (*of_a - at) / a;
  if (of_b) return (*of_b - at) / b;
  return std::nullopt;
}

}  // namespace mortise::simulator
