#include "common/design/metric_registry.h"

#include <algorithm>

namespace mortise::simulator {
namespace {

using enum BuiltInMetric;
using enum MetricSource;

constexpr bool kWithGradient = true;

std::vector<MetricDescription> MetricsOfParts() {
  return {
      {kMass, "mass", "kg", "Mass of all parts.", kParts, kWithGradient},
      {kVolume, "volume", "m^3", "Volume of all parts.", kParts, kWithGradient},
      {kCenterOfMassX, "center_of_mass_x", "m", "Where the centre of mass is along x."},
      {kCenterOfMassY, "center_of_mass_y", "m", "Where the centre of mass is along y."},
      {kCenterOfMassZ, "center_of_mass_z", "m", "Where the centre of mass is along z."},
      {kInertiaXx, "inertia_xx", "kg*m^2",
       "Moment of inertia about the axis along x through the centre of mass."},
      {kInertiaYy, "inertia_yy", "kg*m^2",
       "Moment of inertia about the axis along y through the centre of mass."},
      {kInertiaZz, "inertia_zz", "kg*m^2",
       "Moment of inertia about the axis along z through the centre of mass."},
      {kInertiaXy, "inertia_xy", "kg*m^2",
       "Entry xy of the inertia tensor about the centre of mass: minus the integral of x*y over "
       "the mass."},
      {kInertiaYz, "inertia_yz", "kg*m^2",
       "Entry yz of the inertia tensor about the centre of mass: minus the integral of y*z over "
       "the mass."},
      {kInertiaXz, "inertia_xz", "kg*m^2",
       "Entry xz of the inertia tensor about the centre of mass: minus the integral of x*z over "
       "the mass."},
      {kProjectedAreaX, "projected_area_x", "m^2", "Area of the silhouette seen along x."},
      {kProjectedAreaY, "projected_area_y", "m^2", "Area of the silhouette seen along y."},
      {kProjectedAreaZ, "projected_area_z", "m^2", "Area of the silhouette seen along z."},
      {kDrag, "drag", "N",
       "Drag of a wind of 10 m/s from the front, along -x: half the density of air, times the "
       "speed squared, times the silhouette across it."},
      {kTopplingMargin, "toppling_margin", "m",
       "From below the centre of mass to the nearest edge of the polygon it stands on; negative "
       "where it topples."},
      {kTopplingAngle, "toppling_angle", "rad",
       "By how much the floor may tilt before it topples; negative where it topples on a level "
       "one."},
      {kDisplacedVolume, "displaced_volume", "m^3",
       "Fresh water that it displaces while it floats."},
      {kDraught, "draught", "m", "How deep it lies in fresh water, floating upright."},
      {kFreeboard, "freeboard", "m", "From the water to its highest point, floating upright."},
      {kMetacentricHeight, "metacentric_height", "m",
       "From the centre of mass up to the metacentre, floating upright; negative where it would "
       "capsize."}};
}

std::vector<MetricDescription> MetricsOfTheWhole() {
  return {
      {kSurfaceArea, "surface_area", "m^2", "Area of the outside of all parts joined.", kOutside},
      {kCost, "cost", "", "What the material costs by the prices of the items, without waste.",
       kPrices},
      {kNaturalFrequency, "natural_frequency", "Hz",
       "Lowest frequency at which it vibrates on its supports, other than as a whole.", kModes}};
}

std::vector<MetricDescription> MetricsOfHeat() {
  return {
      {kMaxTemperature, "max_temperature", "K", "Highest temperature at any node.", kHeat},
      {kMinTemperature, "min_temperature", "K", "Lowest temperature at any node.", kHeat},
      {kMeanTemperature, "mean_temperature", "K", "Mean temperature over the volume.", kHeat},
      {kHeatDissipation, "heat_dissipation", "W",
       "Heat that leaves through convections and held temperatures, those that let more out than "
       "in.",
       kHeat}};
}

std::vector<MetricDescription> MetricsOfAirflow() {
  return {{kAirflowDrag, "airflow_drag", "N", "Force of the air along the wind.", kAirflow},
          {kAirflowForceX, "airflow_force_x", "N", "Force of the air along x.", kAirflow},
          {kAirflowForceY, "airflow_force_y", "N", "Force of the air along y.", kAirflow},
          {kAirflowForceZ, "airflow_force_z", "N", "Force of the air along z: lift.", kAirflow},
          {kMaxAirPressure, "max_air_pressure", "Pa",
           "Highest pressure on the outside, above that of the oncoming air.", kAirflow},
          {kMinAirPressure, "min_air_pressure", "Pa",
           "Lowest pressure on the outside, below 0 where the air sucks. At sharp edges it falls "
           "with refinement.",
           kAirflow}};
}

std::vector<MetricDescription> MetricsUnderLoads() {
  return {
      {kMaxDisplacement, "max_displacement", "m",
       "Largest displacement of any point under the loads.", kLoads, kWithGradient},
      {kMaxVonMises, "max_von_mises", "Pa",
       "Largest von Mises stress at any node. At sharp inner corners it grows with refinement.",
       kLoads, kWithGradient},
      {kMaxPrincipal, "max_principal", "Pa",
       "Largest principal stress at any node: what pulls most. At sharp inner corners it grows "
       "with refinement.",
       kLoads, kWithGradient},
      {kCompliance, "compliance", "J",
       "Work of the loads on the displacements, f·u: the smaller, the stiffer.", kLoads,
       kWithGradient},
      {kStrainEnergy, "strain_energy", "J", "Elastic energy stored under the loads.", kLoads,
       kWithGradient},
      {kStressRatio, "stress_ratio", "1",
       "Largest von Mises stress of a part over its material's strength.", kLoads, kWithGradient},
      {kMeanVonMises, "mean_von_mises", "Pa", "Mean of the von Mises stress over the volume.",
       kLoads, kWithGradient},
      {kRmsVonMises, "rms_von_mises", "Pa",
       "Root of the mean of the squared von Mises stress over the volume: the more above the mean, "
       "the less evenly it is spread.",
       kLoads, kWithGradient},
      {kVonMisesP99, "von_mises_p99", "Pa",
       "Von Mises stress that 99 % of the volume is below: other than the largest, it has a limit "
       "at sharp inner corners.",
       kLoads},
      {kVonMisesIntegral, "von_mises_integral", "N*m",
       "Integral of the von Mises stress over the volume.", kLoads, kWithGradient},
      {kRelativeError, "relative_error", "1",
       "Estimated error of the stresses, as a share of all, in the energy norm: 0.05 is good.",
       kLoads}};
}

}  // namespace

const std::vector<MetricDescription>& OfferedMetrics() {
  static const std::vector<MetricDescription> metrics = [] {
    std::vector<MetricDescription> all = MetricsOfParts();
    for (const auto& others :
         {MetricsOfTheWhole(), MetricsOfHeat(), MetricsOfAirflow(), MetricsUnderLoads()}) {
      all.insert(all.end(), others.begin(), others.end());
    }
    return all;
  }();
  return metrics;
}

const MetricDescription* FindMetric(std::string_view name) {
  const auto& all = OfferedMetrics();
  const auto found = std::ranges::find(all, name, &MetricDescription::name);
  return found == all.end() ? nullptr : &*found;
}

const MetricDescription& DescriptionOf(BuiltInMetric metric) {
  return OfferedMetrics()[static_cast<std::size_t>(metric)];
}

std::vector<parametric::NamedUnit> UnitsOf(const std::vector<MetricDescription>& metrics) {
  std::vector<parametric::NamedUnit> units;
  for (const MetricDescription& metric : metrics) units.push_back({metric.name, metric.unit});
  return units;
}

Metric MetricOf(BuiltInMetric metric, double value) {
  const MetricDescription& description = DescriptionOf(metric);
  return {description.name, description.unit, value};
}

}  // namespace mortise::simulator
