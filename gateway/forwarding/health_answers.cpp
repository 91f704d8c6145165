#include "gateway/forwarding/health_answers.h"

#include <optional>
#include <string>
#include <utility>

#include "gateway/admission/call_time.h"
#include "gateway/forwarding/wire.h"

namespace mortise::gateway {
namespace {

// As grpc.health.v1.HealthCheckResponse.ServingStatus numbers them.
enum class Serving : char { kServing = 1, kNotServing = 2, kServiceUnknown = 3 };

// A HealthCheckResponse: its one field, `status`.
grpc::ByteBuffer Response(Serving status) {
  constexpr char kStatusTag = 0x08;
  const char bytes[] = {kStatusTag, static_cast<char>(status)};
  return ToByteBuffer({bytes, sizeof(bytes)});
}

// Whether a HealthCheckRequest asks for the whole door, which has no name: its one field is the
// name, and a field at its default is left out.
bool AsksForAll(const grpc::ByteBuffer& request) {
  constexpr std::string_view kEmptyName("\x0a\x00", 2);
  return request.Length() == 0 || ToString(request) == kEmptyName;
}

}  // namespace

class HealthAnswers::CheckAnswer final : public grpc::ServerGenericBidiReactor {
 public:
  CheckAnswer(HealthAnswers& health, grpc::CallbackServerContext& call,
              std::unique_ptr<OpenCalls::Place> place)
      : health_(health), place_(std::move(place)), time_(call, health.check_time_) {
    StartRead(&message_);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return Finish({grpc::StatusCode::INVALID_ARGUMENT, "the call carries no message"});
    if (!AsksForAll(message_)) {
      return Finish(
          {grpc::StatusCode::NOT_FOUND, "the door as a whole is asked for, without name"});
    }
    bool serving = false;
    {
      const std::lock_guard lock(health_.mutex_);
      serving = health_.serving_;
    }
    message_ = Response(serving ? Serving::kServing : Serving::kNotServing);
    StartWriteAndFinish(&message_, grpc::WriteOptions(), grpc::Status::OK);
  }

  void OnDone() override { delete this; }

 private:
  HealthAnswers& health_;
  const std::unique_ptr<OpenCalls::Place> place_;
  grpc::ByteBuffer message_;
  const CallTime time_;
};

// What it has told is guarded by the mutex of the health.
class HealthAnswers::WatchAnswer final : public grpc::ServerGenericBidiReactor {
 public:
  WatchAnswer(HealthAnswers& health, std::unique_ptr<OpenCalls::Place> place)
      : health_(health), place_(std::move(place)) {
    StartRead(&message_);
  }

  void OnReadDone(bool ok) override {
    const std::lock_guard lock(health_.mutex_);
    if (!ok) {
      return FinishOnce({grpc::StatusCode::INVALID_ARGUMENT, "the call carries no message"});
    }
    known_ = AsksForAll(message_);
    health_.watching_.insert(this);
    Tell();
  }

  void OnWriteDone(bool ok) override {
    const std::lock_guard lock(health_.mutex_);
    writing_ = false;
    if (!ok) return FinishOnce(grpc::Status::CANCELLED);
    Tell();
  }

  void OnCancel() override {
    const std::lock_guard lock(health_.mutex_);
    FinishOnce(grpc::Status::CANCELLED);
  }

  void OnDone() override {
    {
      const std::lock_guard lock(health_.mutex_);
      health_.watching_.erase(this);
    }
    delete this;
  }

  // Tells what is so now unless it was told; the mutex is held.
  void Tell() {
    if (finished_ || writing_) return;
    const Serving of_door = health_.serving_ ? Serving::kServing : Serving::kNotServing;
    const Serving now = known_ ? of_door : Serving::kServiceUnknown;
    if (told_ != now) {
      told_ = now;
      writing_ = true;
      message_ = Response(now);
      return StartWrite(&message_);
    }
    if (health_.ended_) FinishOnce({grpc::StatusCode::UNAVAILABLE, "the gateway is shutting down"});
  }

 private:
  void FinishOnce(const grpc::Status& status) {
    if (!std::exchange(finished_, true)) Finish(status);
  }

  HealthAnswers& health_;
  const std::unique_ptr<OpenCalls::Place> place_;
  grpc::ByteBuffer message_;
  bool known_ = false;
  bool writing_ = false;
  bool finished_ = false;
  std::optional<Serving> told_;
};

bool HealthAnswers::IsCheck(std::string_view path) {
  return path == "/grpc.health.v1.Health/Check";
}

bool HealthAnswers::IsWatch(std::string_view path) {
  return path == "/grpc.health.v1.Health/Watch";
}

void HealthAnswers::SetServing() {
  const std::lock_guard lock(mutex_);
  serving_ = true;
  for (WatchAnswer* watch : watching_) watch->Tell();
}

void HealthAnswers::End() {
  const std::lock_guard lock(mutex_);
  serving_ = false;
  ended_ = true;
  for (WatchAnswer* watch : watching_) watch->Tell();
}

grpc::ServerGenericBidiReactor* HealthAnswers::Check(grpc::CallbackServerContext& call,
                                                     std::unique_ptr<OpenCalls::Place> place) {
  return new CheckAnswer(*this, call, std::move(place));
}

grpc::ServerGenericBidiReactor* HealthAnswers::Watch(std::unique_ptr<OpenCalls::Place> place) {
  return new WatchAnswer(*this, std::move(place));
}

}  // namespace mortise::gateway
