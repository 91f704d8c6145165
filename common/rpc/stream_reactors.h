// Streaming calls as gRPC reactors; used by the wrappers of handler.h.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/call_state.h"
#include "common/rpc/outgoing_stream.h"
#include "common/rpc/status_mapping.h"
#include "common/rpc/stream_writer.h"

namespace mortise::rpc {

// The receiving side of a bidirectional stream. Calls come on the handlers' threads, one at a time;
// the next message is read after OnMessage returns. Destroyed after OnEnd.
template <class Request>
class StreamReader {
 public:
  virtual ~StreamReader() = default;

  // A message, already checked. A failure ends the stream.
  virtual absl::Status OnMessage(const Request& message) = 0;

  // No more messages: the client has finished or gone away, or the stream has ended. Once. Finish
  // the writer when what remains to be sent is sent; a client that has finished may still read.
  virtual void OnEnd() = 0;
};

// The receiving side of an upload. Calls as for StreamReader. Destroyed without Complete if the
// client goes away.
template <class Request, class Response>
class UploadReader {
 public:
  virtual ~UploadReader() = default;
  virtual absl::Status OnMessage(const Request& message) = 0;
  virtual absl::StatusOr<Response> Complete() = 0;
};

// ---- What the reactors share ----------------------------------------------------------------

// Runs `body` for a call that is admitted; why it failed or was not.
template <class Body>
absl::Status RunAdmitted(CallState& call, Body body) {
  MORTISE_RETURN_IF_ERROR(call.Admit());
  return call.RunGuarded(std::move(body));
}

// Hands a message to the reader, if it may see it.
template <class Request, class Reader>
absl::Status Receive(CallState& call, const Request& message, Reader& reader) {
  return call.RunGuarded([&]() -> absl::Status {
    MORTISE_RETURN_IF_ERROR(call.CheckRequest(message));
    return reader.OnMessage(message);
  });
}

// Returns the sending side of `reactor`.
template <class Response, class Reactor>
std::shared_ptr<OutgoingStream<Response>> SendThrough(Reactor* reactor,
                                                      const std::shared_ptr<CallState>& state,
                                                      const StreamOptions& options) {
  return std::make_shared<OutgoingStream<Response>>(
      state, options,
      typename OutgoingStream<Response>::Wire{
          [reactor](const Response* message) { reactor->StartWrite(message); },
          [reactor, call = state.get()](const absl::Status& status) {
            call->End(status);
            reactor->Finish(ToGrpc(status));
          }});
}

template <class Response>
void EndWhenDraining(CallState& call, const std::shared_ptr<OutgoingStream<Response>>& writer) {
  call.OnStop([writer] {
    writer->Finish(
        WithDetail(absl::UnavailableError("the server is shutting down; follow on elsewhere"),
                   {"SHUTTING_DOWN", ""}));
  });
}

// ---- The reactors ---------------------------------------------------------------------------

// A stream from the server.
template <class Response>
class ServerStreamReactor : public grpc::ServerWriteReactor<Response> {
 public:
  using Writer = std::shared_ptr<StreamWriter<Response>>;
  using Handler = std::function<absl::Status(const Call&, const Writer&)>;

  // As UnaryCall::Explanation.
  using Explanation = std::function<absl::Status(const Call&)>;

  static ServerStreamReactor* Start(std::shared_ptr<CallState> state,
                                    const google::protobuf::Message* request,
                                    const StreamOptions& options, Handler handler,
                                    Explanation explanation = nullptr) {
    auto* reactor = new ServerStreamReactor(state, options);  // until OnDone
    auto writer = reactor->writer_;
    if (absl::Status begun = state->Begin(); !begun.ok()) {
      writer->Finish(begun);
      return reactor;
    }
    const Lane lane = state->method().lane;
    state->dispatcher()->Submit(
        [state, writer, request, options, handler = std::move(handler),
         explanation = std::move(explanation)] {
          // Keeps the request alive: it goes with the call, which ends only after Release.
          if (!writer->Hold()) return;
          const absl::Status status = RunAdmitted(*state, [&]() -> absl::Status {
            const auto explain = [&] { return explanation(Call(state)); };
            MORTISE_RETURN_IF_ERROR(state->CheckRequest(
                *request, explanation ? std::function<absl::Status()>(explain) : nullptr));
            return handler(Call(state), writer);
          });
          if (status.ok() && options.endless) EndWhenDraining(*state, writer);
          if (!status.ok()) writer->Finish(status);
          writer->Release();
        },
        lane);
    return reactor;
  }

  void OnWriteDone(bool ok) override { writer_->OnWriteDone(ok); }
  void OnCancel() override {
    state_->Cancel();
    writer_->OnCancel();
  }
  void OnDone() override { delete this; }

 private:
  ServerStreamReactor(std::shared_ptr<CallState> state, const StreamOptions& options)
      : state_(std::move(state)), writer_(SendThrough<Response>(this, state_, options)) {}

  const std::shared_ptr<CallState> state_;
  const std::shared_ptr<OutgoingStream<Response>> writer_;
};

// Streams both ways.
template <class Request, class Response>
class BidiReactor : public grpc::ServerBidiReactor<Request, Response>,
                    public std::enable_shared_from_this<BidiReactor<Request, Response>> {
 public:
  using Writer = std::shared_ptr<StreamWriter<Response>>;
  using Open =
      std::function<absl::StatusOr<std::unique_ptr<StreamReader<Request>>>(const Call&, Writer)>;

  static BidiReactor* Start(std::shared_ptr<CallState> state, const StreamOptions& options,
                            Open open) {
    std::shared_ptr<BidiReactor> reactor(new BidiReactor(state, options));
    reactor->self_ = reactor;
    if (absl::Status begun = state->Begin(); !begun.ok()) {
      reactor->writer_->Finish(begun);
      return reactor.get();
    }
    state->dispatcher()->Submit([reactor, options, open = std::move(open)] {
      CallState& call = *reactor->state_;
      const absl::Status status = RunAdmitted(call, [&]() -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(reactor->reader_, open(Call(reactor->state_), reactor->writer_));
        return absl::OkStatus();
      });
      if (!status.ok()) {
        reactor->writer_->Finish(status);
        return;
      }
      if (options.endless) EndWhenDraining(call, reactor->writer_);
      reactor->ReadNext();
    });
    return reactor.get();
  }

  void OnReadDone(bool ok) override {
    state_->dispatcher()->Submit([self = this->shared_from_this(), ok] {
      if (ok) {
        self->HandleMessage();
      } else {
        self->EndReading();
      }
    });
  }
  void OnWriteDone(bool ok) override { writer_->OnWriteDone(ok); }
  void OnCancel() override {
    state_->Cancel();
    writer_->OnCancel();
  }
  void OnDone() override { self_.reset(); }

 private:
  BidiReactor(std::shared_ptr<CallState> state, const StreamOptions& options)
      : state_(std::move(state)), writer_(SendThrough<Response>(this, state_, options)) {}

  void ReadNext() {
    if (!writer_->Hold()) {
      EndReading();
      return;
    }
    this->StartRead(&message_);
    writer_->Release();
  }

  void HandleMessage() {
    const absl::Status status = Receive(*state_, message_, *reader_);
    if (status.ok()) {
      ReadNext();
      return;
    }
    writer_->Finish(status);
    EndReading();
  }

  void EndReading() {
    absl::Status status = state_->RunGuarded([&]() -> absl::Status {
      reader_->OnEnd();
      return absl::OkStatus();
    });
    if (!status.ok()) writer_->Finish(status);
    reader_.reset();
  }

  const std::shared_ptr<CallState> state_;
  const std::shared_ptr<OutgoingStream<Response>> writer_;
  std::unique_ptr<StreamReader<Request>> reader_;
  Request message_;
  std::shared_ptr<BidiReactor> self_;
};

// A stream from the client with one answer.
template <class Request, class Response>
class UploadReactor : public grpc::ServerReadReactor<Request>,
                      public std::enable_shared_from_this<UploadReactor<Request, Response>> {
 public:
  using Reader = UploadReader<Request, Response>;
  using Open = std::function<absl::StatusOr<std::unique_ptr<Reader>>(const Call&)>;

  static UploadReactor* Start(std::shared_ptr<CallState> state, Response* response, Open open) {
    std::shared_ptr<UploadReactor> reactor(new UploadReactor(state, response));
    reactor->self_ = reactor;
    if (absl::Status begun = state->Begin(); !begun.ok()) {
      reactor->End(begun);
      return reactor.get();
    }
    state->dispatcher()->Submit([reactor, open = std::move(open)] {
      reactor->ReadNextOrEnd(RunAdmitted(*reactor->state_, [&]() -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(reactor->reader_, open(Call(reactor->state_)));
        return absl::OkStatus();
      }));
    });
    return reactor.get();
  }

  void OnReadDone(bool ok) override {
    state_->dispatcher()->Submit([self = this->shared_from_this(), ok] {
      if (ok) {
        self->ReadNextOrEnd(Receive(*self->state_, self->message_, *self->reader_));
      } else {
        self->Complete();
      }
    });
  }
  void OnCancel() override { state_->Cancel(); }
  void OnDone() override { self_.reset(); }

 private:
  UploadReactor(std::shared_ptr<CallState> state, Response* response)
      : state_(std::move(state)), response_(response) {}

  void ReadNextOrEnd(const absl::Status& status) {
    if (status.ok()) {
      this->StartRead(&message_);
    } else {
      End(status);
    }
  }

  void Complete() {
    if (state_->cancelled()) {
      End(absl::CancelledError("the client went away"));
      return;
    }
    End(state_->RunGuarded([&]() -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(*response_, reader_->Complete());
      return absl::OkStatus();
    }));
  }

  void End(const absl::Status& status) {
    reader_.reset();
    state_->End(status);
    this->Finish(ToGrpc(status));
  }

  const std::shared_ptr<CallState> state_;
  Response* const response_;
  std::unique_ptr<Reader> reader_;
  Request message_;
  std::shared_ptr<UploadReactor> self_;
};

}  // namespace mortise::rpc
