#include "common/design/design_metrics.h"

namespace mortise::parametric {

const std::vector<NamedUnit>& DesignMetrics() {
  static const std::vector<NamedUnit> metrics{{"mass", "kg"},
                                              {"volume", "m^3"},
                                              {"center_of_mass_x", "m"},
                                              {"center_of_mass_y", "m"},
                                              {"center_of_mass_z", "m"},
                                              {"inertia_xx", "kg*m^2"},
                                              {"inertia_yy", "kg*m^2"},
                                              {"inertia_zz", "kg*m^2"},
                                              {"inertia_xy", "kg*m^2"},
                                              {"inertia_yz", "kg*m^2"},
                                              {"inertia_xz", "kg*m^2"},
                                              {"projected_area_x", "m^2"},
                                              {"projected_area_y", "m^2"},
                                              {"projected_area_z", "m^2"},
                                              {"drag", "N"},
                                              {"toppling_margin", "m"},
                                              {"toppling_angle", "rad"},
                                              {"displaced_volume", "m^3"},
                                              {"draught", "m"},
                                              {"freeboard", "m"},
                                              {"metacentric_height", "m"},
                                              {"surface_area", "m^2"},
                                              {"cost", ""},
                                              {"natural_frequency", "Hz"},
                                              {"max_temperature", "K"},
                                              {"min_temperature", "K"},
                                              {"mean_temperature", "K"},
                                              {"heat_dissipation", "W"},
                                              {"airflow_drag", "N"},
                                              {"airflow_force_x", "N"},
                                              {"airflow_force_y", "N"},
                                              {"airflow_force_z", "N"},
                                              {"max_air_pressure", "Pa"},
                                              {"min_air_pressure", "Pa"},
                                              {"max_displacement", "m"},
                                              {"max_von_mises", "Pa"},
                                              {"max_principal", "Pa"},
                                              {"compliance", "J"},
                                              {"strain_energy", "J"},
                                              {"stress_ratio", "1"},
                                              {"relative_error", "1"}};
  return metrics;
}

}  // namespace mortise::parametric
