// Turns: a limited number of things that run at once; the others wait in their order.
#pragma once

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <deque>
#include <memory>

#include "gateway/awaitable.h"

namespace mortise::gateway {

// Used by coroutines of one strand.
class Turns {
 public:
  explicit Turns(int count) : free_(count) {}

  // Waits for a turn and takes it. It is given back by Return.
  boost::asio::awaitable<void> Take() {
    if (free_ > 0) {
      --free_;
      co_return;
    }
    auto turn = std::make_shared<boost::asio::steady_timer>(
        co_await boost::asio::this_coro::executor, boost::asio::steady_timer::time_point::max());
    waiting_.push_back(turn);
    boost::system::error_code cancelled;
    co_await turn->async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, cancelled));
  }

  // Passes a turn on to whoever waits longest.
  void Return() {
    if (waiting_.empty()) {
      ++free_;
      return;
    }
    waiting_.front()->cancel();
    waiting_.pop_front();
  }

 private:
  int free_;
  std::deque<std::shared_ptr<boost::asio::steady_timer>> waiting_;
};

}  // namespace mortise::gateway
