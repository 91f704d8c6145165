// So much of something for all, and less for each.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"

namespace mortise::gateway {

// Bodies and messages up to this are counted by their connections and calls alone, so that those of
// usual calls are taken however many large ones are under way.
inline constexpr std::size_t kSmallBodyBytes = 64 * 1024;

// Thread safe.
class Budget {
 public:
  // `of_each` is what one who is named may have at a time.
  Budget(int64_t of_all, int64_t of_each) : of_all_(of_all), of_each_(of_each) {}

  // What was taken; given back when it goes. The budget must outlive it.
  class Share {
   public:
    Share(Budget& budget, std::string who, int64_t amount)
        : budget_(budget), who_(std::move(who)), amount_(amount) {}
    ~Share() { budget_.GiveBack(who_, amount_); }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

   private:
    Budget& budget_;
    const std::string who_;
    const int64_t amount_;
  };

  // Null if there is not so much left, of all or for `who`.
  std::unique_ptr<Share> Take(const std::string& who, int64_t amount);

 private:
  void GiveBack(const std::string& who, int64_t amount);

  const int64_t of_all_;
  const int64_t of_each_;
  std::mutex mutex_;
  int64_t taken_ = 0;                        // guarded by mutex_
  std::map<std::string, int64_t> taken_by_;  // guarded by mutex_; none is 0
};

// Returns RESOURCE_EXHAUSTED, TOO_MANY_CALLS: `what` is too many at a time.
absl::Status TooManyAtATime(std::string_view what);

}  // namespace mortise::gateway
