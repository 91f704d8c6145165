// The performance buffer (§7.5.1) stores a front along rays from the origin of performance space.
//
// Scale performance so that the ideal point is the origin and the nadir (1, ..., 1). By Proposition
// 1 a ray from the origin meets the front at most once, at the point nearest to the origin. Write a
// scaled performance y >= 0 in hyperspherical coordinates,
//
//   r = |y|,   phi_k = atan2(|(y_{k+1}, ..., y_d)|, y_k)  in [0, pi/2],   k = 1 ... d-1,
//
// and cut each angle into n equal parts: a ray's cell. Each cell keeps the candidates whose
// distance r lies within delta_B of the cell's least, at most `candidates_per_cell` of them,
// nearest first. Cells are stored sparsely, so that the memory follows the front and not n^(d-1).
//
// For many metrics no n is right beforehand: with n = 16, a front of six metrics may pass a million
// cells, or ten. So n can adapt: with a `cell_limit`, Rebuild takes the finest of n, 3/4 n, 9/16 n,
// ... at which no more cells than that are occupied, and is due as well when twice as many are.
//
// Real ranges are unknown at first, so the scaling runs along: Rebuild is due when the ideal or the
// nadir has moved by a tenth of the range that the cells were made for.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

class PerformanceBuffer {
 public:
  struct Options {
    int cells_per_angle = 1000;     // n; the finest, where there is a limit
    std::size_t cell_limit = 0;     // occupied cells after Rebuild, at most; 0: any number
    double tolerance = 1e-2;        // delta_B, in scaled performance
    int candidates_per_cell = 50;   // K
    double rebuild_movement = 0.1;  // of ideal or nadir, relative to the range
  };

  struct Candidate {
    std::size_t entry = 0;  // index into the archive
    double distance = 0;    // r, from the origin of scaled performance
  };

  using CellId = std::int64_t;

  PerformanceBuffer(const Options& options, Eigen::Index metric_count);

  // Returns the cell of a scaled performance, 0 <= id < CellCount(). Negative coordinates count as
  // 0.
  CellId CellOf(const Eigen::VectorXd& scaled) const;

  // Returns the unit vector along the ray through the middle of a cell.
  Eigen::VectorXd DirectionOf(CellId cell) const;

  // Returns n, at present.
  int cells_per_angle() const { return cells_per_angle_; }

  // Returns d.
  Eigen::Index metric_count() const { return metric_count_; }

  // Returns n^(d-1).
  CellId CellCount() const;

  // Offers an entry; returns whether it became a candidate. `improvement` (optional) is set to how
  // much nearer to the origin the cell's best has come; a new cell counts as 1.
  bool Insert(std::size_t entry, const Eigen::VectorXd& scaled, double* improvement = nullptr);

  // Whether the scaling has moved so far from the one in use that Rebuild is due, or cells have
  // become too many.
  bool NeedsRebuild(const Scaling& current) const;

  // Empties the cells, adopts the scaling, chooses n, and inserts every feasible entry of the
  // archive.
  void Rebuild(const Archive& archive, const Scaling& scaling);

  const Scaling& scaling() const { return scaling_; }
  double tolerance() const { return options_.tolerance; }

  // Returns the occupied cells in ascending order, each with its candidates, nearest first.
  const std::map<CellId, std::vector<Candidate>>& cells() const { return cells_; }

 private:
  void Refill(const Archive& archive);
  bool MayCoarsen() const;

  Options options_;
  Eigen::Index metric_count_;
  int cells_per_angle_;
  Scaling scaling_;
  std::map<CellId, std::vector<Candidate>> cells_;
};

}  // namespace mortise::pareto
