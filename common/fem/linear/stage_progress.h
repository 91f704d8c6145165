// Tells how far a computation is: which of its stages it is in. One thread computes and tells,
// another one reads.
#pragma once

#include <mutex>
#include <string>

namespace mortise::simulator {

// Thread safe.
class StageProgress {
 public:
  struct State {
    std::string stage;  // what is being done: "mesh", "load case 2 of 5: iteration 12"; "" at first
    int done = 0;       // stages behind: fewer than total, as the last is not behind before the end
    int total = 0;      // stages in all; 0 until they are known
  };

  // Says how many stages there are in all, those that have begun included.
  void Expect(int stages);

  // Says that there are so many more: work that was not known to be needed.
  void Add(int stages);

  // Says what the stages from now on belong to, which goes before their names; "" for nothing.
  void Within(std::string work);

  // Notes that a stage begins, and the one before it is done.
  void Begin(std::string stage);

  // Notes that the present stage is at this iteration, from 1; 0 where it does not iterate.
  void Iterate(int iteration);

  State state() const;

 private:
  mutable std::mutex mutex_;
  std::string work_;  // guarded by mutex_, as all below
  std::string stage_;
  int iteration_ = 0;
  int begun_ = 0;
  int total_ = 0;
};

}  // namespace mortise::simulator
