// A fixed number of connections, opened when first needed, each used by one thread at a time.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::store {

template <typename Connection>
class ConnectionPool {
 public:
  using Open = std::function<absl::StatusOr<std::unique_ptr<Connection>>()>;

  ConnectionPool(int size, Open open) : unopened_(size), open_(std::move(open)) {}

  // A connection on loan; goes back to the pool at the end of its scope.
  class Loan {
   public:
    Loan(ConnectionPool* pool, std::unique_ptr<Connection> connection)
        : pool_(pool), connection_(std::move(connection)) {}
    Loan(Loan&& other) noexcept = default;
    Loan& operator=(Loan&& other) = delete;
    ~Loan() {
      if (connection_) pool_->GiveBack(std::move(connection_));
    }

    Connection* operator->() const { return connection_.get(); }
    Connection* get() const { return connection_.get(); }

   private:
    ConnectionPool* pool_;
    std::unique_ptr<Connection> connection_;
  };

  // Waits for a free connection, or opens one.
  absl::StatusOr<Loan> Take() {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return !free_.empty() || unopened_ > 0; });
      if (!free_.empty()) {
        std::unique_ptr<Connection> connection = std::move(free_.back());
        free_.pop_back();
        return Loan(this, std::move(connection));
      }
      --unopened_;
    }
    absl::StatusOr<std::unique_ptr<Connection>> opened = open_();
    if (opened.ok()) return Loan(this, *std::move(opened));
    std::lock_guard lock(mutex_);
    ++unopened_;
    changed_.notify_one();
    return opened.status();
  }

 private:
  void GiveBack(std::unique_ptr<Connection> connection) {
    std::lock_guard lock(mutex_);
    free_.push_back(std::move(connection));
    changed_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Connection>> free_;  // guarded by mutex_
  int unopened_;                                   // guarded by mutex_
  Open open_;
};

}  // namespace mortise::store
