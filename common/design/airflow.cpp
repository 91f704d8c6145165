#include "common/design/airflow.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::parametric {
namespace {

constexpr double kMolarGasConstant = 8314.462618;  // J/(kmol K)
constexpr double kGasConstant = kMolarGasConstant / kMolarMassOfAir;

constexpr double kSlowest = 1, kFastest = 240;     // m/s
constexpr double kMaxMach = 0.7;                   // the solver is subsonic
constexpr double kColdest = 150, kHottest = 1000;  // K, of Sutherland's law
constexpr double kThinnest = 1e3, kDensest = 1e6;  // Pa
constexpr int kMinCells = 2000, kMaxCells = 5'000'000;

}  // namespace

double Air::Density() const { return pressure / (kGasConstant * temperature); }

double Air::Viscosity() const {
  return 1.458e-6 * std::pow(temperature, 1.5) / (temperature + 110.4);
}

double Air::SpeedOfSound() const {
  return std::sqrt(kHeatCapacityOfAir / (kHeatCapacityOfAir - kGasConstant) * kGasConstant *
                   temperature);
}

absl::Status CheckAirflow(const Airflow& airflow) {
  const Air& air = airflow.air;
  std::vector<FieldViolation> faults;
  const bool has_temperature = air.temperature >= kColdest && air.temperature <= kHottest;
  const double sound = has_temperature ? air.SpeedOfSound() : Air().SpeedOfSound();
  const double fastest = std::min(kFastest, kMaxMach * sound);
  const double speed = airflow.wind.norm();
  if (!(speed >= kSlowest && speed <= fastest)) {
    faults.push_back({"wind", absl::StrCat("must be ", kSlowest, " to ", std::floor(fastest),
                                           " m/s in all: above that the flow is transonic")});
  }
  if (!has_temperature) {
    faults.push_back({"temperature", absl::StrCat("must be ", kColdest, " to ", kHottest, " K")});
  }
  if (!(air.pressure >= kThinnest && air.pressure <= kDensest)) {
    faults.push_back({"pressure", absl::StrCat("must be ", kThinnest, " to ", kDensest, " Pa")});
  }
  if (airflow.cells < kMinCells || airflow.cells > kMaxCells) {
    faults.push_back({"cells", absl::StrCat("must be ", kMinCells, " to ", kMaxCells)});
  }
  return faults.empty() ? absl::OkStatus() : InvalidFields(faults);
}

}  // namespace mortise::parametric
