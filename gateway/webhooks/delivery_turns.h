// Turns: a limited number of things that run at once; the others wait in their order.
#pragma once

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <deque>
#include <memory>
#include <utility>

#include "gateway/forwarding/awaitable.h"

namespace mortise::gateway {

// Used by coroutines of one strand. Outlives what they run on, as coroutines that are ended with it
// give their turns back.
class Turns {
 public:
  explicit Turns(int count) : free_(count) {}

  // A turn that was taken; passed on when it goes, however that comes.
  class Turn {
   public:
    explicit Turn(Turns& turns) : turns_(&turns) {}
    Turn(Turn&& other) noexcept : turns_(std::exchange(other.turns_, nullptr)) {}
    Turn& operator=(Turn&&) = delete;
    ~Turn() {
      if (turns_ != nullptr) turns_->Return();
    }

   private:
    Turns* turns_;
  };

  // Waits for a turn and takes it.
  boost::asio::awaitable<Turn> Take() {
    if (free_ > 0) {
      --free_;
      co_return Turn(*this);
    }
    auto turn = std::make_shared<boost::asio::steady_timer>(
        co_await boost::asio::this_coro::executor, boost::asio::steady_timer::time_point::max());
    waiting_.push_back(turn);
    boost::system::error_code cancelled;
    co_await turn->async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, cancelled));
    co_return Turn(*this);
  }

 private:
  // Passes a turn on to whoever waits longest.
  void Return() {
    while (!waiting_.empty()) {
      const auto next = waiting_.front().lock();
      waiting_.pop_front();
      if (next == nullptr) continue;  // it waits no longer
      next->cancel();
      return;
    }
    ++free_;
  }

  int free_;
  std::deque<std::weak_ptr<boost::asio::steady_timer>> waiting_;
};

}  // namespace mortise::gateway
