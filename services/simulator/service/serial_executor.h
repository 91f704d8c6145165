// Work that is done one piece after another, on whichever of a dispatcher's threads.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "common/rpc/dispatcher.h"

namespace mortise::simulator {

// Keeps long work of many callers from holding all threads at once, and what it locks from others
// for longer than one piece. Thread safe.
class SerialExecutor {
 public:
  // The dispatcher must outlive what is submitted.
  explicit SerialExecutor(rpc::Dispatcher* dispatcher)
      : state_(std::make_shared<State>(dispatcher)) {}

  // Runs `piece` after all that were submitted before.
  void Submit(std::function<void()> piece);

 private:
  struct State {
    explicit State(rpc::Dispatcher* of) : dispatcher(of) {}
    rpc::Dispatcher* const dispatcher;
    std::mutex mutex;
    std::deque<std::function<void()>> pieces;  // guarded by mutex
    bool is_running = false;                   // guarded by mutex
  };

  // Lets the next piece run at its end, also of one that throws.
  class Turn {
   public:
    explicit Turn(std::shared_ptr<State> state) : state_(std::move(state)) {}
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn();

   private:
    const std::shared_ptr<State> state_;
  };

  static void SubmitNext(const std::shared_ptr<State>& state);

  const std::shared_ptr<State> state_;
};

}  // namespace mortise::simulator
