#include "common/host/operation_service.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/page_rule.h"
#include "common/resources/resource_filter.h"
#include "common/rpc/call_state.h"
#include "common/rpc/handler.h"
#include "mortise/v1/operations.grpc.pb.h"

namespace mortise::rpc {
namespace {

constexpr double kDefaultWait = 60;    // s
constexpr double kLongestWait = 3600;  // s
// How long before the caller's deadline a wait answers, so that the answer still arrives.
constexpr absl::Duration kAnswerTime = absl::Milliseconds(100);

constexpr std::size_t kShownText = 100;  // bytes of what somebody asked for

// Of operations that were started before their methods were kept: as much as any of these needed.
constexpr Role kRoleOfUnknownMethod = Role::kOperator;

// The role of the method that started an operation, as the proto says.
Role RoleToStart(const jobs::Operation& operation) {
  const std::string& method = operation.method;
  const std::size_t slash = method.find('/');
  if (slash == std::string::npos) return kRoleOfUnknownMethod;
  const MethodInfo starter = FindMethod(method.substr(0, slash), method.substr(slash + 1));
  return starter.usable.ok() ? starter.role : kRoleOfUnknownMethod;
}

// PERMISSION_DENIED naming the method that started it, where that takes more than `role`.
absl::Status CheckMayStop(Role role, const jobs::Operation& operation) {
  const Role needed = RoleToStart(operation);
  if (role >= needed) return absl::OkStatus();
  const std::string starter =
      operation.method.empty() ? "an earlier version of Mortise" : operation.method;
  return WithDetail(
      absl::PermissionDeniedError(absl::StrCat("cancelling what ", starter,
                                               " started needs the role '", RoleName(needed), "'")),
      {"ROLE_REQUIRED", operation.method.empty() ? operation.name : operation.method});
}

// Holds a watch until the wait it serves is over.
struct Waiting {
  std::mutex mutex;
  std::unique_ptr<jobs::OperationWatch> watch;
};

class OperationAdapter : public v1::OperationService::CallbackService {
 public:
  OperationAdapter(Dispatcher* dispatcher, jobs::Operations* operations)
      : dispatcher_(dispatcher),
        operations_(operations),
        endpoint_(dispatcher, "mortise.v1.OperationService") {}

  grpc::ServerUnaryReactor* GetOperation(grpc::CallbackServerContext* context,
                                         const v1::GetOperationRequest* request,
                                         v1::Operation* response) override {
    return endpoint_.Query(
        "GetOperation", context, request, response,
        [this](const Call&, const v1::GetOperationRequest& asked) { return Find(asked.name()); });
  }

  grpc::ServerUnaryReactor* ListOperations(grpc::CallbackServerContext* context,
                                           const v1::ListOperationsRequest* request,
                                           v1::ListOperationsResponse* response) override {
    return endpoint_.Query(
        "ListOperations", context, request, response,
        [this](const Call&, const v1::ListOperationsRequest& asked) { return List(asked); });
  }

  grpc::ServerUnaryReactor* CancelOperation(grpc::CallbackServerContext* context,
                                            const v1::CancelOperationRequest* request,
                                            v1::Operation* response) override {
    // Cancelling has a transaction of its own; it may be repeated, so it goes first.
    return endpoint_.PreparedMutation(
        "CancelOperation", context, request, response,
        [this](const Call& call, const v1::CancelOperationRequest& asked) {
          return Cancel(call, asked.name());
        },
        [](const Call&, const v1::CancelOperationRequest&, const v1::Operation& operation,
           store::Transaction&) -> absl::StatusOr<v1::Operation> { return operation; });
  }

  grpc::ServerUnaryReactor* WaitOperation(grpc::CallbackServerContext* context,
                                          const v1::WaitOperationRequest* request,
                                          v1::Operation* response) override {
    return endpoint_.AsyncQuery(
        "WaitOperation", context, request, response,
        [this](const Call& call, const v1::WaitOperationRequest& asked,
               Responder<v1::Operation> respond) { return Wait(call, asked, respond); });
  }

  grpc::ServerWriteReactor<v1::Operation>* WatchOperation(
      grpc::CallbackServerContext* context, const v1::WatchOperationRequest* request) override {
    return endpoint_.ServerStream<v1::Operation>(
        "WatchOperation", context, request,
        [this](const Call&, const v1::WatchOperationRequest& asked,
               const std::shared_ptr<StreamWriter<v1::Operation>>& writer) {
          return Watch(asked, writer);
        },
        {.endless = true});
  }

 private:
  absl::StatusOr<v1::Operation> Find(const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(jobs::Operation operation, operations_->Get(name));
    return ToProto(operation);
  }

  // Who may not start an operation may not stop it either.
  absl::StatusOr<v1::Operation> Cancel(const Call& call, const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(const jobs::Operation present, operations_->Get(name));
    MORTISE_RETURN_IF_ERROR(CheckMayStop(call.identity().role, present));
    MORTISE_ASSIGN_OR_RETURN(const jobs::Operation operation, operations_->Cancel(name));
    return ToProto(operation);
  }

  // What an operation works on may be gone, so any resource name will do.
  static absl::Status CheckSubject(const std::string& subject) {
    if (subject.empty()) return absl::OkStatus();
    const std::size_t slash = subject.find('/');
    if (slash == std::string::npos || slash == 0) {
      return InvalidField("subject", absl::StrCat("'", subject.substr(0, kShownText),
                                                  "' is no resource name, such as fronts/a1"));
    }
    return ParseResourceName(subject, subject.substr(0, slash), "subject").status();
  }

  // Each service knows the kinds of all, so that none is taken for one that has nothing to show.
  static absl::Status CheckKind(const std::string& kind) {
    const auto& kinds = jobs::kOperationKinds;
    if (kind.empty() || std::find(std::begin(kinds), std::end(kinds), kind) != std::end(kinds)) {
      return absl::OkStatus();
    }
    return InvalidField("kind", absl::StrCat("'", kind.substr(0, kShownText), "' is none of ",
                                             absl::StrJoin(kinds, ", ")));
  }

  // The page token is the name of the last operation on the page before.
  absl::StatusOr<v1::ListOperationsResponse> List(const v1::ListOperationsRequest& asked) {
    const auto query = resources::ReadPageQuery(asked);
    const auto wanted = resources::ResourceFilter::Of(asked);
    auto states = StatesFrom(asked.states());
    MORTISE_RETURN_IF_ERROR(
        Together(Together(Together(query.status(), states.status()), CheckKind(asked.kind())),
                 Together(CheckSubject(asked.subject()), wanted.status())));
    const jobs::OperationFilter filter{.states = *std::move(states),
                                       .kind = asked.kind(),
                                       .subject = asked.subject(),
                                       .takes = [&](const jobs::Operation& operation) {
                                         return wanted->Takes(ToProto(operation));
                                       }};
    v1::ListOperationsResponse response;
    if (!asked.service().empty() && asked.service() != dispatcher_->options().service) {
      return response;
    }
    const auto begin = [&]() -> jobs::Operations::Visitor {
      response.Clear();
      return
          [&, room = resources::PageRoom(query->size)](const jobs::Operation& operation) mutable {
            v1::Operation proto = ToProto(operation);
            if (asked.omit_results()) proto.clear_result();
            if (room.Take(proto.ByteSizeLong())) {
              *response.add_operations() = std::move(proto);
              return true;
            }
            response.set_next_page_token(response.operations().rbegin()->name());
            return false;
          };
    };
    const absl::Status visited = operations_->Visit(query->after, filter, begin);
    if (absl::IsInvalidArgument(visited)) return resources::NotAPageToken();
    MORTISE_RETURN_IF_ERROR(visited);
    return response;
  }

  absl::Status Wait(const Call& call, const v1::WaitOperationRequest& asked,
                    const Responder<v1::Operation>& respond) {
    if (asked.timeout_seconds() < 0 || asked.timeout_seconds() > kLongestWait) {
      return InvalidField("timeout_seconds", "must be 0 to 3600");
    }
    const double seconds = asked.has_timeout_seconds() ? asked.timeout_seconds() : kDefaultWait;
    auto answer_now = [this, respond, name = asked.name()] { respond(Find(name)); };
    auto waiting = std::make_shared<Waiting>();
    // The watch must not go away within its own callback, so the answer is given elsewhere.
    MORTISE_ASSIGN_OR_RETURN(
        auto watch,
        operations_->Watch(asked.name(), [this, respond](const jobs::Operation& operation) {
          if (!jobs::IsFinal(operation.state)) return;
          dispatcher_->Submit([respond, proto = ToProto(operation)] { respond(proto); },
                              Lane::kStreams);
        }));
    {
      std::lock_guard lock(waiting->mutex);
      waiting->watch = std::move(watch);
    }
    // The call's stop callback holds the watch; it is dropped when the call is answered.
    call.OnStop([waiting, answer_now] { answer_now(); });
    const absl::Duration time =
        std::min(absl::Seconds(seconds), call.deadline() - absl::Now() - kAnswerTime);
    dispatcher_->SubmitAfter(
        std::max(time, absl::ZeroDuration()),
        [still_waiting = std::weak_ptr(waiting), answer_now] {
          if (still_waiting.lock()) answer_now();
        },
        Lane::kStreams);
    return absl::OkStatus();
  }

  absl::Status Watch(const v1::WatchOperationRequest& asked,
                     const std::shared_ptr<StreamWriter<v1::Operation>>& writer) {
    MORTISE_ASSIGN_OR_RETURN(
        std::shared_ptr<jobs::OperationWatch> watch,
        operations_->Watch(asked.name(), [writer](const jobs::Operation& operation) {
          writer->WriteLatest(ToProto(operation));
          if (jobs::IsFinal(operation.state)) writer->Finish(absl::OkStatus());
        }));
    writer->OnEnd([watch] {});  // keeps it until then
    return absl::OkStatus();
  }

  Dispatcher* const dispatcher_;
  jobs::Operations* const operations_;
  Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeOperationService(Dispatcher* dispatcher,
                                                    jobs::Operations* operations) {
  return std::make_shared<OperationAdapter>(dispatcher, operations);
}

}  // namespace mortise::rpc
