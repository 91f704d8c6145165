// A stream both ways over which somebody follows a thing while a hand moves it: the client begins,
// sends values as fast as they come, and is answered for the latest. It is the frame of such
// methods: which messages may come when, and what waits. What the values mean is the subject's.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/rpc/stream_reactors.h"
#include "common/rpc/stream_writer.h"

namespace mortise::rpc {

// What is followed over one stream. Begin is called first, then Take and Answer, which may be
// called at the same time: each has members of its own, and both only read what Begin has set. Each
// is called by one thread at a time.
template <class Request, class Response>
class FollowedSubject {
 public:
  // What a message is that does not begin.
  enum class Kind {
    kValue,  // it counts until the next comes
    kLast,   // it counts instead of the value that waits, and nothing comes after it
  };

  virtual ~FollowedSubject() = default;

  // Takes the message that begins. Returns what is to be sent before any answer. A failure ends the
  // stream.
  virtual absl::StatusOr<std::vector<Response>> Begin(const Request& message) = 0;

  // Checks a further message, as soon as it has come, and says what it is. A failure ends the
  // stream.
  virtual absl::StatusOr<Kind> Take(const Request& message) = 0;

  // Returns the answer to a message that Take has let pass, in as many messages as it takes. A
  // failure ends the stream.
  virtual absl::StatusOr<std::vector<Response>> Answer(const Request& message) = 0;
};

// ---- How it is done -------------------------------------------------------------------------

// What waits on a stream, shared by who takes messages and who answers them.
template <class Request, class Response>
class LatestValue {
 public:
  using Subject = FollowedSubject<Request, Response>;
  using Kind = typename Subject::Kind;

  explicit LatestValue(std::shared_ptr<Subject> subject) : subject_(std::move(subject)) {}

  absl::Status Begin(const Request& message) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<Response> first, subject_->Begin(message));
    Append(std::move(first));
    return absl::OkStatus();
  }

  // Whether it is the last.
  absl::StatusOr<bool> Take(const Request& message) {
    MORTISE_ASSIGN_OR_RETURN(const Kind kind, subject_->Take(message));
    const std::lock_guard lock(mutex_);
    waiting_ = message;
    is_last_ = kind == Kind::kLast;
    return is_last_;
  }

  void End() {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }

  // What is to be sent next; nothing if there is none yet. Called by one at a time. `is_over` says
  // whether the stream ends here.
  absl::StatusOr<std::optional<Response>> Next(bool* is_over) {
    while (ready_.empty()) {
      std::optional<Request> message;
      {
        const std::lock_guard lock(mutex_);
        message = std::exchange(waiting_, std::nullopt);
        if (!message) {
          *is_over = has_ended_;
          return std::optional<Response>();
        }
        has_ended_ = has_ended_ || is_last_;
      }
      MORTISE_ASSIGN_OR_RETURN(std::vector<Response> answer, subject_->Answer(*message));
      Append(std::move(answer));
    }
    std::optional<Response> next(std::move(ready_.front()));
    ready_.pop_front();
    return next;
  }

 private:
  void Append(std::vector<Response> messages) {
    for (Response& message : messages) ready_.push_back(std::move(message));
  }

  const std::shared_ptr<Subject> subject_;
  std::deque<Response> ready_;  // of Begin, and then of who answers
  std::mutex mutex_;
  // Guarded by mutex_:
  std::optional<Request> waiting_;
  bool is_last_ = false;  // what waits
  bool has_ended_ = false;
};

template <class Request, class Response>
class LatestValueStream : public StreamReader<Request> {
 public:
  using Subject = FollowedSubject<Request, Response>;
  using Writer = std::shared_ptr<StreamWriter<Response>>;

  LatestValueStream(std::shared_ptr<Subject> subject, Writer writer)
      : value_(std::make_shared<LatestValue<Request, Response>>(std::move(subject))),
        writer_(std::move(writer)) {}

  absl::Status OnMessage(const Request& message) override {
    if (is_over_) return InvalidField("message", "nothing comes after the last one");
    if (message.has_begin() == has_begun_) {
      return InvalidField("message",
                          has_begun_ ? "it has begun already" : "the first must be begin");
    }
    if (!has_begun_) {
      MORTISE_RETURN_IF_ERROR(value_->Begin(message));
      has_begun_ = true;
      BeginAnswering();
      return absl::OkStatus();
    }
    MORTISE_ASSIGN_OR_RETURN(is_over_, value_->Take(message));
    writer_->Wake();
    return absl::OkStatus();
  }

  void OnEnd() override {
    if (!has_begun_) {
      writer_->Finish(InvalidField("message", "no begin was sent"));
      return;
    }
    value_->End();
    writer_->Wake();
  }

 private:
  void BeginAnswering() {
    // The writer keeps what it calls, which must not keep the writer.
    const std::weak_ptr<StreamWriter<Response>> weak = writer_;
    writer_->Pull([value = value_, weak]() -> absl::StatusOr<std::optional<Response>> {
      bool is_over = false;
      auto next = value->Next(&is_over);
      const Writer writer = weak.lock();
      if (is_over && writer != nullptr) writer->Finish(absl::OkStatus());
      return next;
    });
  }

  const std::shared_ptr<LatestValue<Request, Response>> value_;
  const Writer writer_;
  bool has_begun_ = false;
  bool is_over_ = false;
};

// ---- What services call ---------------------------------------------------------------------

// Returns the receiving side of such a stream. `Request` has a message `begin` among its choices,
// and so `has_begin()`; its first message must be that, and no other may. Of values that wait only
// the latest is kept, and the next answer is begun when all of the one before is sent: whatever a
// client sends, one value and one answer wait at most. When the client has finished, what waits is
// answered, and the stream ends. INVALID_ARGUMENT, "message", where messages come in another order,
// and where none does; otherwise the stream fails as the subject does.
template <class Request, class Response>
std::unique_ptr<StreamReader<Request>> FollowLatest(
    std::shared_ptr<FollowedSubject<Request, Response>> subject,
    std::shared_ptr<StreamWriter<Response>> writer) {
  return std::make_unique<LatestValueStream<Request, Response>>(std::move(subject),
                                                                std::move(writer));
}

}  // namespace mortise::rpc
