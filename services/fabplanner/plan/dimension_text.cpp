#include "services/fabplanner/plan/dimension_text.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace mortise::fabplanner {

std::string Millimetres(double metres) {
  const double tenths = std::round(metres * 1e4);
  if (std::fmod(tenths, 10.0) == 0) return absl::StrFormat("%.0f", tenths / 10 + 0.0);
  return absl::StrFormat("%.1f", tenths / 10);
}

std::string SizeText(const Eigen::Vector3d& size) {
  return absl::StrCat(Millimetres(size.x()), " × ", Millimetres(size.y()), " × ",
                      Millimetres(size.z()), " mm");
}

}  // namespace mortise::fabplanner
