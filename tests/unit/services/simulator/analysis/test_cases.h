// Cases that several tests of the simulator solve.
#pragma once

#include "services/simulator/analysis/design_analysis.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::simulator {

inline Material Spruce() { return {"spruce", 450, 11e9, 0.3, 30e6}; }

// A beam along x: clamped at x_min, pulled down at x_max.
inline DesignModel Cantilever(double length, double side, double force, double poissons_ratio) {
  DesignModel model;
  model.surface = mesh::AssembleBoxes({{"beam", {0, 0, 0}, {length, side, side}}});
  model.analysis.materials = {{"test", 1000, 10e9, poissons_ratio, 0}};
  model.analysis.supports.push_back({{0, "x_min"}});
  model.analysis.forces.push_back({{0, "x_max"}, {0, 0, -force}});
  return model;
}

// A table of nine parts: the top loaded, the feet fixed.
inline DesignModel LoadedTable() {
  DesignModel model;
  model.surface = mesh::TestTable();
  model.analysis.materials.assign(9, Spruce());
  model.analysis.forces.push_back({{0, "z_max"}, {0, 0, -1000}});
  for (int leg = 1; leg <= 4; ++leg) model.analysis.supports.push_back({{leg, "z_min"}});
  return model;
}

}  // namespace mortise::simulator
