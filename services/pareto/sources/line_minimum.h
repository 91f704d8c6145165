// Finds the least value of a function of one variable on [0, 1] that may have many local minima, as
// ask and tell, several points at once.
//
// It begins with a few points that cover the range, its ends among them. If parabolas through
// neighbours tell what was found between them, these are enough; if not, the function ripples, and
// gaps are halved until they do, or up to a limit. Then parabolas lead down from the best few
// points that are better than their neighbours, fewer each time.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "common/base/random.h"

namespace mortise::pareto {

class LineMinimum {
 public:
  struct Options {
    int values = 64;          // that cover a function that ripples, roughly; at least 3
    double roughness = 0.03;  // mean deviation from parabolas, over the range, of a ripple
    double tolerance = 1e-5;  // of the range of values, where parabolas end
  };

  // Begins with a value that is known already.
  LineMinimum(const Options& options, double known, double value, Random& random);

  // Returns the next point; nullopt while it waits, or once finished.
  std::optional<double> Ask();

  // Takes the value at a point, as asked for or where it came to lie; infinite where there is no
  // value.
  void Tell(double point, double value);

  bool Finished() const { return finished_; }

  // Whether parabolas told what lies between neighbours only after many values, or never.
  bool rippled() const { return rippled_; }

 private:
  void NextStage();
  void QueueHalves();
  bool Ripples() const;
  void QueueVertices(std::size_t valleys);
  std::optional<double> VertexAt(double point) const;
  double Least() const;
  double Most() const;

  Options options_;
  Random random_;
  std::map<double, double> values_;  // by point
  bool rippled_ = false;
  bool covering_ = true;     // else leading down
  std::size_t covered_ = 0;  // points known when it last looked for ripples
  double least_ = 0;         // when the present round of parabolas began
  int rounds_ = 0;           // of parabolas
  std::deque<double> queue_;
  int outstanding_ = 0;
  bool finished_ = false;
};

}  // namespace mortise::pareto
