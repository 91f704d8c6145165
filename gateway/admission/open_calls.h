// How many calls are open, of whom and to which service, and how many may be.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gateway/contract/contract.h"

namespace mortise::gateway {

inline constexpr char kCountedMetadata[] = "mortise-counted";

// At a time. To a service: no more than its connections carry, since others would wait unseen; of a
// subject: less, so that nobody keeps all others out.
struct OpenCallLimits {
  struct Limit {
    int of_subject;
    int of_service;
  };
  Limit calls = {1200, 1600};
  Limit waits = {1200, 1600};
  Limit streams = {256, 1600};
  Limit urgent = {100, 800};

  const Limit& Of(CallKind kind) const;
};

// Thread safe.
class OpenCalls {
 public:
  explicit OpenCalls(OpenCallLimits limits);
  OpenCalls(const OpenCalls&) = delete;
  OpenCalls& operator=(const OpenCalls&) = delete;

  // One call, counted until it goes.
  class Place {
   public:
    Place(OpenCalls& calls, CallKind kind, std::string subject)
        : calls_(calls), kind_(kind), subject_(std::move(subject)) {}
    ~Place();
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    // The call goes to this service; once. RESOURCE_EXHAUSTED, TOO_MANY_CALLS or TOO_MANY_STREAMS
    // if it has too many already.
    absl::Status EnterService(const std::string& service);

   private:
    OpenCalls& calls_;
    const CallKind kind_;
    const std::string subject_;
    std::string service_;
  };

  // Begins a call of a subject; it must end before this does. RESOURCE_EXHAUSTED,
  // TOO_MANY_CALLS or TOO_MANY_STREAMS if the subject has too many.
  absl::StatusOr<std::unique_ptr<Place>> Enter(CallKind kind, const std::string& subject);

  // Returns what the HTTP door sends with a call that it has counted itself, as metadata
  // `kCountedMetadata`. Nobody else knows it.
  const std::string& pass() const { return pass_; }

 private:
  enum class Whose { kSubject, kService };
  using Key = std::tuple<Whose, CallKind, std::string>;

  absl::Status Count(Key key);
  void Uncount(const Key& key);

  const OpenCallLimits limits_;
  const std::string pass_;
  std::mutex mutex_;
  std::map<Key, int> open_;  // guarded by mutex_; none is 0
};

}  // namespace mortise::gateway
