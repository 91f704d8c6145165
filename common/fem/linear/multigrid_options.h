// Says how a multigrid preconditioner works; the defaults were found by measurement
// (docs/simulator.md).
#pragma once

namespace mortise::simulator {

struct MultigridOptions {
  bool corners = true;              // quadratic elements step down to linear ones first, unless
                                    // they are mostly twenty times as long as high
  int quadratic_steps = 3;          // of the smoother on quadratic elements, on each side
  int linear_steps = 2;             // on the levels below
  double smoothed_part = 1.0 / 12;  // the smoother takes eigenvalues from this part of the largest
  double strength = 0.02;           // blocks weaker than this, next to the diagonal ones,
                                    // do not join nodes; a quarter of it level by level
};

}  // namespace mortise::simulator
