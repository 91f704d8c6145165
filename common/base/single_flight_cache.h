// What is costly to make, by key: made once however many ask for it at the same time, kept as long
// as it fits into a number of bytes, and forgotten in the order of its last use.
//
//   SingleFlightCache<std::shared_ptr<const Design>> designs(std::size_t{256} << 20);
//   MORTISE_ASSIGN_OR_RETURN(const auto design, designs.Get(digest, [&] { return Compile(bundle);
//   }));
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise {

// What becomes of a value that alone takes more than a cache has room for.
enum class Oversize {
  kForgotten,  // it goes to those who asked for it, and is made again for the next
  kAlone,      // it is kept, and nothing else is, until another value is made
};

// Thread safe. Values are copied out: let them be cheap to copy. No lock is held while a value is
// made, so one may be made of others of the same cache; but not of itself.
template <typename Value>
class SingleFlightCache {
 public:
  // A value, and the memory that it takes as long as it is kept, in bytes.
  struct Made {
    Value value;
    std::size_t bytes = 0;
  };
  using Make = std::function<absl::StatusOr<Made>()>;

  // `capacity`, bytes: of all values together.
  explicit SingleFlightCache(std::size_t capacity, Oversize oversize = Oversize::kForgotten)
      : capacity_(capacity), oversize_(oversize) {}

  // Returns the value if it is kept; it counts as used.
  std::optional<Value> Find(const std::string& key) {
    const std::lock_guard lock(mutex_);
    return FindKept(key);
  }

  // Returns the value that is kept; else the one that another thread is making, when it is there;
  // else what `make` gives on this thread. A failure is told to all who wait for it, and not kept.
  // But what fails because of who asked (cancelled, past a deadline, without permission) is tried
  // again for each of the others.
  absl::StatusOr<Value> Get(const std::string& key, const Make& make) {
    std::unique_lock lock(mutex_);
    while (true) {
      if (std::optional<Value> kept = FindKept(key)) return *std::move(kept);
      const auto under_way = flights_.find(key);
      if (under_way == flights_.end()) break;
      const std::shared_ptr<Flight> flight = under_way->second;
      ++waiting_;
      landed_.wait(lock, [&flight] { return flight->result.has_value(); });
      --waiting_;
      if (!IsOfTheCaller(flight->result->status())) return *flight->result;
    }
    const auto flight = std::make_shared<Flight>();
    flights_[key] = flight;
    lock.unlock();
    Landing landing(*this, key, flight);
    return landing.Settle(make());
  }

  // Returns how much is kept, bytes.
  std::size_t bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }

  // Returns how many calls of Get wait for what others make.
  std::size_t waiting() const {
    const std::lock_guard lock(mutex_);
    return waiting_;
  }

 private:
  struct Entry {
    std::string key;
    Made made;
  };
  struct Flight {
    std::optional<absl::StatusOr<Value>> result;
  };

  // Tells those who wait, even where making a value throws.
  class Landing {
   public:
    Landing(SingleFlightCache& cache, const std::string& key, std::shared_ptr<Flight> flight)
        : cache_(cache), key_(key), flight_(std::move(flight)) {}
    Landing(const Landing&) = delete;
    Landing& operator=(const Landing&) = delete;
    ~Landing() {
      const std::lock_guard lock(cache_.mutex_);
      if (!flight_->result) flight_->result = absl::InternalError("it could not be made");
      cache_.flights_.erase(key_);
      cache_.landed_.notify_all();
    }

    absl::StatusOr<Value> Settle(absl::StatusOr<Made> made) {
      const std::lock_guard lock(cache_.mutex_);
      if (!made.ok()) {
        flight_->result = made.status();
        return made.status();
      }
      flight_->result = made->value;
      Value value = made->value;
      cache_.Keep({key_, *std::move(made)});
      return value;
    }

   private:
    SingleFlightCache& cache_;
    const std::string& key_;
    const std::shared_ptr<Flight> flight_;
  };

  static bool IsOfTheCaller(const absl::Status& status) {
    return absl::IsCancelled(status) || absl::IsDeadlineExceeded(status) ||
           absl::IsPermissionDenied(status) || absl::IsUnauthenticated(status);
  }

  // The mutex is held by who calls these.
  std::optional<Value> FindKept(const std::string& key) {
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return std::nullopt;
    entries_.splice(entries_.begin(), entries_, found->second);
    return entries_.front().made.value;
  }

  void Keep(Entry entry) {
    if (entry.made.bytes > capacity_ && oversize_ == Oversize::kForgotten) return;
    bytes_ += entry.made.bytes;
    entries_.push_front(std::move(entry));
    by_key_[entries_.front().key] = entries_.begin();
    while (bytes_ > capacity_ && entries_.size() > 1) {
      bytes_ -= entries_.back().made.bytes;
      by_key_.erase(entries_.back().key);
      entries_.pop_back();
    }
  }

  const std::size_t capacity_;
  const Oversize oversize_;
  mutable std::mutex mutex_;
  std::condition_variable landed_;
  // Guarded by mutex_:
  std::list<Entry> entries_;  // most recently used first
  std::map<std::string, typename std::list<Entry>::iterator> by_key_;
  std::map<std::string, std::shared_ptr<Flight>> flights_;  // of what is being made
  std::size_t bytes_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace mortise
