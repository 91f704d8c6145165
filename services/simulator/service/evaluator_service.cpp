#include "services/simulator/service/evaluator_service.h"

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/files/evaluation_settings.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/handler.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/difference_gradients.h"
#include "services/simulator/service/evaluation_batch.h"
#include "services/simulator/service/evaluation_subject.h"
#include "services/simulator/service/evaluator_records.h"
#include "services/simulator/service/serial_executor.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/worker/result_cache.h"
#include "services/simulator/worker/subject_metrics.h"

namespace mortise::simulator {
namespace {

constexpr int kMaximumPoints = 1000;
constexpr std::size_t kCachedResults = 20000;

class EvaluatorAdapter final : public v1::EvaluatorService::CallbackService {
 public:
  explicit EvaluatorAdapter(const std::shared_ptr<SimulatorCore>& core)
      : core_(core), endpoint_(core->dispatcher(), "mortise.v1.EvaluatorService") {}

  grpc::ServerUnaryReactor* DescribeDesignSpace(grpc::CallbackServerContext* context,
                                                const v1::DescribeDesignSpaceRequest* request,
                                                v1::DesignSpace* response) override {
    return endpoint_.Query(
        "DescribeDesignSpace", context, request, response,
        [this](const rpc::Call& call,
               const v1::DescribeDesignSpaceRequest& asked) -> absl::StatusOr<v1::DesignSpace> {
          MORTISE_ASSIGN_OR_RETURN(
              EvaluationSubject subject,
              FindSubject(*core_, asked.subject(), asked.revision(), asked.metric_definitions(),
                          rpc::ForwardedFrom(call)));
          return std::move(subject.space);
        });
  }

  grpc::ServerUnaryReactor* CreateEvaluator(grpc::CallbackServerContext* context,
                                            const v1::CreateEvaluatorRequest* request,
                                            v1::Evaluator* response) override {
    return endpoint_.Mutation("CreateEvaluator", context, request, response,
                              [](const rpc::Call& call, const v1::CreateEvaluatorRequest& asked,
                                 store::Transaction& transaction) -> absl::StatusOr<v1::Evaluator> {
                                MORTISE_RETURN_IF_ERROR(CheckEvaluator(asked.evaluator()));
                                return simulator::CreateEvaluator(transaction, asked.evaluator(),
                                                                  call.identity().trace_id);
                              });
  }

  grpc::ServerUnaryReactor* GetEvaluator(grpc::CallbackServerContext* context,
                                         const v1::GetEvaluatorRequest* request,
                                         v1::Evaluator* response) override {
    return endpoint_.Query("GetEvaluator", context, request, response,
                           [this](const rpc::Call&, const v1::GetEvaluatorRequest& asked) {
                             return Read([&](store::ReadTransaction& read) {
                               return simulator::GetEvaluator(read, asked.name(), "name");
                             });
                           });
  }

  grpc::ServerUnaryReactor* ListEvaluators(grpc::CallbackServerContext* context,
                                           const v1::ListEvaluatorsRequest* request,
                                           v1::ListEvaluatorsResponse* response) override {
    return endpoint_.Query("ListEvaluators", context, request, response,
                           [this](const rpc::Call&, const v1::ListEvaluatorsRequest& asked) {
                             return Read([&](store::ReadTransaction& read) {
                               return simulator::ListEvaluators(read, asked);
                             });
                           });
  }

  grpc::ServerUnaryReactor* DeleteEvaluator(grpc::CallbackServerContext* context,
                                            const v1::DeleteEvaluatorRequest* request,
                                            v1::DeleteEvaluatorResponse* response) override {
    return endpoint_.Mutation(
        "DeleteEvaluator", context, request, response,
        [](const rpc::Call& call, const v1::DeleteEvaluatorRequest& asked,
           store::Transaction& transaction) -> absl::StatusOr<v1::DeleteEvaluatorResponse> {
          MORTISE_RETURN_IF_ERROR(
              simulator::DeleteEvaluator(transaction, asked.name(), call.identity().trace_id));
          return v1::DeleteEvaluatorResponse();
        });
  }

  grpc::ServerWriteReactor<v1::EvaluationResult>* EvaluateBatch(
      grpc::CallbackServerContext* context, const v1::EvaluateBatchRequest* request) override {
    return endpoint_.ServerStream<v1::EvaluationResult>(
        "EvaluateBatch", context, request,
        [this](const rpc::Call& call, const v1::EvaluateBatchRequest& asked,
               const EvaluationBatch::Writer& writer) { return Evaluate(call, asked, writer); },
        {.capacity = kMaximumPoints + 8});
  }

 private:
  // What `find` gives, of one state of the store.
  template <typename Find>
  std::invoke_result_t<Find, store::ReadTransaction&> Read(const Find& find) {
    std::optional<std::invoke_result_t<Find, store::ReadTransaction&>> found;
    MORTISE_RETURN_IF_ERROR(core_->store()->Read([&](store::ReadTransaction& read) {
      found = find(read);
      return found->status();
    }));
    return *std::move(found);
  }

  absl::Status Evaluate(const rpc::Call& call, const v1::EvaluateBatchRequest& asked,
                        const EvaluationBatch::Writer& writer) {
    if (asked.points_size() < 1 || asked.points_size() > kMaximumPoints) {
      return InvalidField("points", absl::StrCat("must be 1 to ", kMaximumPoints));
    }
    const std::vector<std::string> metrics(asked.metrics().begin(), asked.metrics().end());
    MORTISE_RETURN_IF_ERROR(parametric::CheckMeshSettings(asked.mesh()));
    MORTISE_RETURN_IF_ERROR(parametric::ReadAirflow(asked.airflow()).status());
    MORTISE_ASSIGN_OR_RETURN(const EvaluationSubject subject,
                             FindSubject(*core_, asked.subject(), asked.revision(),
                                         asked.metric_definitions(), rpc::ForwardedFrom(call)));
    MORTISE_RETURN_IF_ERROR(CheckMetrics(subject.space, metrics));
    MORTISE_RETURN_IF_ERROR(CheckDifferences(asked, subject.space.parameters_size()));
    const auto batch =
        std::make_shared<EvaluationBatch>(core_, cache_, queueing_, writer, asked.points_size());
    writer->OnEnd([batch] { batch->Abandon(); });
    const auto space = std::make_shared<const v1::DesignSpace>(subject.space);
    v1::Task task = TaskOf(asked, subject, call.identity().trace_id);
    std::vector<EvaluationBatch::Evaluation> evaluations;
    for (int i = 0; i < asked.points_size(); ++i) {
      const auto send = [batch, i](v1::EvaluationResult result) {
        result.set_index(i);
        batch->Send(result);
      };
      const absl::Status usable =
          CheckPoint(subject.space, asked.points(i), absl::StrCat("points[", i, "]"));
      if (!usable.ok()) {
        send(FailedResult(usable));
        continue;
      }
      *task.mutable_point() = asked.points(i);
      evaluations.push_back(
          {task, asked.difference_step() == 0
                     ? EvaluationBatch::Receiver(send)
                     : WithDifferences(batch, space, task, asked.difference_step(), send)});
    }
    batch->Evaluate(std::move(evaluations));
    return absl::OkStatus();
  }

  // What all points of a batch have in common.
  static v1::Task TaskOf(const v1::EvaluateBatchRequest& asked, const EvaluationSubject& subject,
                         const std::string& trace_id) {
    v1::Task task;
    task.set_evaluator(subject.queue);
    task.set_subject(subject.space.subject());
    task.set_revision(subject.space.revision());
    task.set_digest(subject.digest);
    *task.mutable_metrics() = asked.metrics();
    task.set_gradients(asked.gradients());
    *task.mutable_mesh() = asked.mesh();
    *task.mutable_metric_definitions() = asked.metric_definitions();
    if (asked.has_airflow()) *task.mutable_airflow() = asked.airflow();
    task.set_trace_id(trace_id);
    return task;
  }

  const std::shared_ptr<SimulatorCore> core_;
  const std::shared_ptr<ResultCache> cache_ = std::make_shared<ResultCache>(kCachedResults);
  const std::shared_ptr<SerialExecutor> queueing_ =
      std::make_shared<SerialExecutor>(core_->dispatcher());
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeEvaluatorService(const std::shared_ptr<SimulatorCore>& core) {
  return std::make_shared<EvaluatorAdapter>(core);
}

}  // namespace mortise::simulator
