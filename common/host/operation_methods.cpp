#include "common/host/operation_methods.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/page_rule.h"
#include "common/resources/resource_filter.h"
#include "common/rpc/call_state.h"
#include "common/rpc/dispatcher.h"

namespace mortise::rpc::methods {
namespace {

constexpr double kDefaultWait = 60;  // s
constexpr double kMaxWait = 3600;    // s
// How long before the caller's deadline a wait answers, so that the answer still arrives.
constexpr absl::Duration kAnswerTime = absl::Milliseconds(100);

constexpr std::size_t kShownText = 100;  // bytes of what somebody asked for

// Of operations that were started before their methods were kept: as much as any of these needed.
constexpr Role kRoleOfUnknownMethod = Role::kOperator;

// The role of the method that started an operation, as the proto says.
Role RoleToStart(const operations::Operation& operation) {
  const std::string& method = operation.method;
  const std::size_t slash = method.find('/');
  if (slash == std::string::npos) return kRoleOfUnknownMethod;
  const MethodInfo starter = FindMethod(method.substr(0, slash), method.substr(slash + 1));
  return starter.usable.ok() ? starter.role : kRoleOfUnknownMethod;
}

// PERMISSION_DENIED naming the method that started it, where that takes more than `role`.
absl::Status CheckMayStop(Role role, const operations::Operation& operation) {
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
  std::unique_ptr<operations::OperationWatch> watch;
};

absl::StatusOr<v1::Operation> Find(operations::Operations& operations, const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation, operations.Get(name));
  return ToProto(operation);
}

// What an operation works on may be gone, so any resource name will do.
absl::Status CheckSubject(const std::string& subject) {
  if (subject.empty()) return absl::OkStatus();
  const std::size_t slash = subject.find('/');
  if (slash == std::string::npos || slash == 0) {
    return InvalidField("subject", absl::StrCat("'", subject.substr(0, kShownText),
                                                "' is no resource name, such as fronts/a1"));
  }
  return ParseResourceName(subject, subject.substr(0, slash), "subject").status();
}

// Each service knows the kinds of all, so that none is taken for one that has nothing to show.
absl::Status CheckKind(const std::string& kind) {
  const auto& kinds = operations::kOperationKinds;
  if (kind.empty() || std::find(std::begin(kinds), std::end(kinds), kind) != std::end(kinds)) {
    return absl::OkStatus();
  }
  return InvalidField("kind", absl::StrCat("'", kind.substr(0, kShownText), "' is none of ",
                                           absl::StrJoin(kinds, ", ")));
}

}  // namespace

absl::StatusOr<v1::Operation> GetOperation(const HostedOperations& host, const Call&,
                                           const v1::GetOperationRequest& asked) {
  return Find(*host.operations, asked.name());
}

absl::StatusOr<v1::ListOperationsResponse> ListOperations(const HostedOperations& host, const Call&,
                                                          const v1::ListOperationsRequest& asked) {
  const auto query = resources::ReadPageQuery(asked);
  const auto wanted = resources::ResourceFilter::Of(asked);
  auto states = StatesFrom(asked.states());
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(CombineViolations(CombineViolations(query.status(), states.status()),
                                          CheckKind(asked.kind())),
                        CombineViolations(CheckSubject(asked.subject()), wanted.status())));
  v1::ListOperationsResponse response;
  if (!asked.service().empty() && asked.service() != host.dispatcher->options().service) {
    return response;
  }
  const operations::OperationFilter filter{.states = *std::move(states),
                                           .kind = asked.kind(),
                                           .subject = asked.subject(),
                                           .takes = [&](const operations::Operation& operation) {
                                             return wanted->Matches(ToProto(operation));
                                           }};
  const auto begin = [&]() -> operations::Operations::Visitor {
    response.Clear();
    return [&, room = resources::PageRoom(query->size)](
               const operations::Operation& operation) mutable {
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
  const absl::Status visited = host.operations->Visit(query->after, filter, begin);
  if (absl::IsInvalidArgument(visited)) return resources::NotAPageToken();
  MORTISE_RETURN_IF_ERROR(visited);
  return response;
}

// Who may not start an operation may not stop it either.
absl::StatusOr<v1::Operation> StopOperation(const HostedOperations& host, const Call& call,
                                            const v1::CancelOperationRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const operations::Operation present, host.operations->Get(asked.name()));
  MORTISE_RETURN_IF_ERROR(CheckMayStop(call.identity().role, present));
  MORTISE_ASSIGN_OR_RETURN(const operations::Operation stopped,
                           host.operations->Cancel(asked.name()));
  return ToProto(stopped);
}

absl::StatusOr<v1::Operation> CancelOperation(const HostedOperations&, const Call&,
                                              const v1::CancelOperationRequest&,
                                              const v1::Operation& stopped, store::Transaction&) {
  return stopped;
}

absl::Status WaitOperation(const HostedOperations& host, const Call& call,
                           const v1::WaitOperationRequest& asked,
                           const std::function<void(absl::StatusOr<v1::Operation>)>& respond) {
  if (asked.timeout_seconds() < 0 || asked.timeout_seconds() > kMaxWait) {
    return InvalidField("timeout_seconds", "must be 0 to 3600");
  }
  const double seconds = asked.has_timeout_seconds() ? asked.timeout_seconds() : kDefaultWait;
  auto answer_now = [operations = host.operations, respond, name = asked.name()] {
    respond(Find(*operations, name));
  };
  auto waiting = std::make_shared<Waiting>();
  // The watch must not go away within its own callback, so the answer is given elsewhere.
  MORTISE_ASSIGN_OR_RETURN(
      auto watch, host.operations->Watch(asked.name(), [dispatcher = host.dispatcher, respond](
                                                           const operations::Operation& operation) {
        if (!operations::IsFinal(operation.state)) return;
        dispatcher->Submit([respond, proto = ToProto(operation)] { respond(proto); },
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
  host.dispatcher->SubmitAfter(
      std::max(time, absl::ZeroDuration()),
      [still_waiting = std::weak_ptr(waiting), answer_now] {
        if (still_waiting.lock()) answer_now();
      },
      Lane::kStreams);
  return absl::OkStatus();
}

absl::Status WatchOperation(const HostedOperations& host, const Call&,
                            const v1::WatchOperationRequest& asked,
                            const std::shared_ptr<StreamWriter<v1::Operation>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(
      std::shared_ptr<operations::OperationWatch> watch,
      host.operations->Watch(asked.name(), [writer](const operations::Operation& operation) {
        writer->WriteLatest(ToProto(operation));
        if (operations::IsFinal(operation.state)) writer->Finish(absl::OkStatus());
      }));
  writer->OnEnd([watch] {});  // keeps it until then
  return absl::OkStatus();
}

}  // namespace mortise::rpc::methods
