// Chooses which parts are crosscut from which board: one-dimensional cutting stock with the saw's
// kerf, trimmed ends and several stock lengths.
//
// The front end of a board is trimmed by `trim` (the blade cuts within it); then the parts follow,
// each cut off by a blade of width `kerf`; at least `trim` stays at the far end as part of the
// offcut. So n parts fit a board of length L when
//
//     l_1 + … + l_n + (n − 1) kerf ≤ L − 2 trim,
//
// which is bin packing of sizes l_i + kerf into L − 2 trim + kerf, solved by bin_packing.h in units
// of a nanometre. Boards of least total cost are wanted; by default a board costs its length.
//
// Where some ends are mitred or bevelled, parts are turned and put behind each other so that ends
// that run alike meet: one cut makes both (sloped_packing.h). The kerf is then measured along the
// board, and `trim` from its ends to the points of parts that are nearest to them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {

// A length in which the stock is sold.
struct StockLength {
  double length = 0;  // m, > 0
  double cost = 0;    // any unit, > 0; 0 for all means that each costs its length
};

struct CrosscutPart {
  std::string label;  // for messages
  double length = 0;  // m, > 0, from its foremost to its last point
  CutEnds ends = {};  // at most as steep as its length allows: they do not cross within it
};

struct CuttingStockOptions {
  double kerf = 0.003;             // m, >= 0
  double trim = 0.010;             // m, >= 0, at each end
  int64_t search_steps = 3000000;  // bound on the exact search; below a second
  // m, of the boards: width and thickness; needed where ends are not square.
  Eigen::Vector2d section = Eigen::Vector2d::Zero();
};

// A board and its parts from the front end.
struct CutBoard {
  int stock = 0;               // index of the stock length
  std::vector<int> parts;      // indices of the parts
  std::vector<double> starts;  // m from the front end, of each part's foremost point
  std::vector<CutEnds> ends;   // of each part as it lies
  double offcut = 0;           // m left at the far end behind the last cut, >= 0
};

struct CuttingStock {
  std::vector<CutBoard> boards;
  double cost = 0;         // of all boards
  double lower_bound = 0;  // no way of cutting costs less
  bool optimal = false;    // proven to cost least
};

// Cuts every part once. INVALID_ARGUMENT for unusable numbers; FAILED_PRECONDITION, reason
// PART_TOO_LONG, naming the part and the lengths, if a part is longer than every stock allows.
absl::StatusOr<CuttingStock> CutStock(const std::vector<CrosscutPart>& parts,
                                      const std::vector<StockLength>& stock,
                                      const CuttingStockOptions& options = {});

}  // namespace mortise::fabplanner
