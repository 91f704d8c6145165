// The queue between a handler and a stream's wire; used by the wrappers of handler.h.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/rpc/call_state.h"
#include "common/rpc/stream_writer.h"

namespace mortise::rpc {

// One write is on the wire at a time, and the end comes after the last. gRPC is never called with
// the mutex held: it is `writing_` and `held_` that keep the reactor alive meanwhile.
template <class Response>
class OutgoingStream : public StreamWriter<Response>,
                       public std::enable_shared_from_this<OutgoingStream<Response>> {
 public:
  using Next = std::function<absl::StatusOr<std::optional<Response>>()>;
  struct Wire {
    std::function<void(const Response*)> write;
    std::function<void(const absl::Status&)> finish;
  };

  OutgoingStream(std::shared_ptr<CallState> state, const StreamOptions& options, Wire wire)
      : state_(std::move(state)), capacity_(options.capacity), wire_(std::move(wire)) {}

  bool Write(Response message) override {
    {
      std::lock_guard lock(mutex_);
      if (Closed()) return false;
      if (static_cast<int>(queue_.size()) >= capacity_) {
        queue_.clear();
        end_ = WithDetail(absl::ResourceExhaustedError(
                              "the reader is too slow; follow on from the last message received"),
                          {"SLOW_READER", ""});
      } else {
        queue_.push_back(std::move(message));
      }
    }
    Pump();
    std::lock_guard lock(mutex_);
    return !Closed();
  }

  bool WriteLatest(Response message) override {
    {
      std::lock_guard lock(mutex_);
      if (Closed()) return false;
      if (!queue_.empty()) queue_.pop_back();
      queue_.push_back(std::move(message));
    }
    Pump();
    return true;
  }

  void Pull(Next next) override {
    {
      std::lock_guard lock(mutex_);
      if (Closed()) return;
      next_ = std::make_shared<Next>(std::move(next));
      wake_ = true;
    }
    Pump();
  }

  void Wake() override {
    {
      std::lock_guard lock(mutex_);
      wake_ = true;
    }
    Pump();
  }

  void Finish(absl::Status status) override {
    {
      std::lock_guard lock(mutex_);
      if (Closed()) return;
      end_ = std::move(status);
    }
    Pump();
  }

  bool cancelled() const override { return state_->cancelled(); }

  void OnEnd(std::function<void()> callback) override {
    {
      std::lock_guard lock(mutex_);
      if (!finished_) {
        end_callbacks_.push_back(std::move(callback));
        return;
      }
    }
    state_->dispatcher()->Submit(std::move(callback), state_->method().lane);
  }

  // The wire has taken the message, or broke.
  void OnWriteDone(bool ok) {
    {
      std::lock_guard lock(mutex_);
      writing_ = false;
      if (!ok) broken_ = true;
    }
    Pump();
  }

  // The client has gone away.
  void OnCancel() {
    {
      std::lock_guard lock(mutex_);
      broken_ = true;
    }
    Pump();
  }

  // While held, the stream is not finished. False if it already is.
  bool Hold() {
    std::lock_guard lock(mutex_);
    if (finished_) return false;
    held_ = true;
    return true;
  }

  void Release() {
    {
      std::lock_guard lock(mutex_);
      held_ = false;
    }
    Pump();
  }

 private:
  // How many messages are pulled ahead of the wire, so that reading and sending overlap.
  static constexpr std::size_t kReadAhead = 2;

  bool Closed() const { return finished_ || broken_ || end_.has_value(); }

  // Does what can be done now: one write, one pull, or the end.
  void Pump() {
    // The end lets go of the reactor, which may be the last to hold this.
    const auto self = this->shared_from_this();
    std::unique_lock lock(mutex_);
    if (finished_) return;
    if (next_ && wake_ && !pulling_ && !Closed() && queue_.size() < kReadAhead) {
      pulling_ = true;
      wake_ = false;
      state_->dispatcher()->Submit([self = this->shared_from_this()] { self->RunNext(); },
                                   state_->method().lane);
    }
    if (writing_ || held_) return;
    if (broken_) {
      queue_.clear();
      end_ = absl::CancelledError("the client went away");
    }
    if (!queue_.empty()) {
      on_wire_ = std::move(queue_.front());
      queue_.pop_front();
      writing_ = true;
      lock.unlock();
      wire_.write(&on_wire_);
      return;
    }
    if (!end_.has_value()) return;
    finished_ = true;
    next_.reset();
    std::vector<std::function<void()>> callbacks = std::exchange(end_callbacks_, {});
    const absl::Status status = *end_;
    lock.unlock();
    for (auto& callback : callbacks) {
      state_->dispatcher()->Submit(std::move(callback), state_->method().lane);
    }
    wire_.finish(status);
  }

  void RunNext() {
    std::shared_ptr<Next> next;
    {
      std::lock_guard lock(mutex_);
      next = next_;
    }
    std::optional<Response> message;
    absl::Status status = absl::OkStatus();
    if (next) {
      status = state_->RunGuarded([&]() -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(message, (*next)());
        return absl::OkStatus();
      });
    }
    {
      std::lock_guard lock(mutex_);
      pulling_ = false;
      if (!status.ok() && !Closed()) end_ = status;
      if (message.has_value() && !finished_ && !broken_) {
        queue_.push_back(*std::move(message));
        wake_ = true;
      }
    }
    Pump();
  }

  const std::shared_ptr<CallState> state_;
  const int capacity_;
  const Wire wire_;
  mutable std::mutex mutex_;
  std::deque<Response> queue_;
  Response on_wire_;  // owned by gRPC while writing_
  std::shared_ptr<Next> next_;
  bool wake_ = false;
  bool pulling_ = false;
  bool writing_ = false;
  bool held_ = false;
  bool broken_ = false;
  bool finished_ = false;
  std::optional<absl::Status> end_;
  std::vector<std::function<void()>> end_callbacks_;
};

}  // namespace mortise::rpc
