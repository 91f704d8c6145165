#include "services/simulator/service/serial_executor.h"

#include <utility>

namespace mortise::simulator {

void SerialExecutor::Submit(std::function<void()> piece) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->pieces.push_back(std::move(piece));
    if (std::exchange(state_->is_running, true)) return;
  }
  SubmitNext(state_);
}

// A submission for each piece, so that others' come between.
void SerialExecutor::SubmitNext(const std::shared_ptr<State>& state) {
  state->dispatcher->Submit([state] {
    std::function<void()> piece;
    {
      const std::lock_guard lock(state->mutex);
      piece = std::move(state->pieces.front());
      state->pieces.pop_front();
    }
    const Turn turn(state);
    piece();
  });
}

SerialExecutor::Turn::~Turn() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->is_running = !state_->pieces.empty();
    if (!state_->is_running) return;
  }
  SubmitNext(state_);
}

}  // namespace mortise::simulator
