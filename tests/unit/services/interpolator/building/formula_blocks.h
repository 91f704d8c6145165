// Designs for tests of maps with shapes: blocks of cells whose length and width follow from two
// parameters, with fields that are formulas of them, and files of both kept in memory.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "services/interpolator/building/map_building.h"

namespace mortise::interpolator {

struct FormulaBlock {
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  // m
  int cells = 3;                                   // along each edge of the two larger faces
  bool has_hole = false;                           // a round one through the middle, along z
  // Fields at a place in the block (0 to 1 along each edge); left out where there is none.
  std::function<double(const Eigen::Vector3d&)> temperature;  // K, of nodes
  std::function<double(const Eigen::Vector3d&)> stress;       // Pa, of tetrahedra
};

// With control points, paths, and the region "held".
fields::DesignFields MakeBlock(const FormulaBlock& block);

// Files by their digests, which count what is put. Thread safe.
class FileShelf {
 public:
  absl::StatusOr<std::string> Put(const std::string& bytes);
  absl::StatusOr<std::string> Get(const std::string& digest) const;
  int puts() const;
  void Remove(const std::string& digest);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> files_;
  int puts_ = 0;
};

// Maps of x and y in [0, 1], with `metrics` of "sum".
MapPlan BlockPlan(int evaluations, int metrics);

// A block of 1 + x by 1 + y / 2 by 1/4 m, whose temperature bends along y and whose stress along x.
FormulaBlock PlainBlock(const Eigen::VectorXd& design);

// Builds with blocks: evaluation puts their files on the shelf, which outlives the options.
BuildOptions BlockOptions(const MapPlan& plan, FileShelf& shelf, int lanes, int batch, int threads,
                          std::function<FormulaBlock(const Eigen::VectorXd&)> make = PlainBlock);

}  // namespace mortise::interpolator
