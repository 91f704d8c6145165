// So much of something for all, and less for each.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace mortise::gateway {

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

}  // namespace mortise::gateway
