#include "services/interpolator/service/verify_operation.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/random.h"
#include "common/fields/fields_file.h"
#include "common/host/operation_codec.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/map_evaluator.h"
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/map_records.h"
#include "services/interpolator/service/plan_request.h"
#include "services/interpolator/service/shape_verification.h"

namespace mortise::interpolator {
namespace {

// Points one after the other, as a request has them.
google::protobuf::RepeatedField<double> RandomPoints(const v1::DesignMap& map, int count,
                                                     std::uint64_t seed) {
  Random random(seed);
  google::protobuf::RepeatedField<double> points;
  for (int i = 0; i < count; ++i) {
    const v1::MapStructure& structure = map.structures(
        static_cast<int>(random.Index(static_cast<std::size_t>(map.structures_size()))));
    int whole = 0;
    for (const v1::MapParameter& parameter : map.parameters()) {
      points.Add(parameter.whole()
                     ? structure.values(whole++).value()
                     : parameter.minimum() +
                           random.Uniform() * (parameter.maximum() - parameter.minimum()));
    }
  }
  return points;
}

// Each design that an evaluator knows and the map has values of, by how much they differ.
struct Differences {
  std::int64_t failed = 0;
  std::int64_t uncovered = 0;
  std::vector<std::vector<double>> of_metrics;  // one list for each metric
};

// An answer without a number is as good as none.
bool IsUsable(const DesignAnswer& answer) {
  return answer.status.ok() && answer.values.allFinite();
}

Differences Compare(const v1::EvaluateMapResponse& mapped,
                    const std::vector<DesignAnswer>& answers) {
  const int metrics = mapped.metrics_size();
  const std::set<int> uncovered(mapped.uncovered().begin(), mapped.uncovered().end());
  Differences differences;
  differences.of_metrics.resize(static_cast<std::size_t>(metrics));
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const int first = static_cast<int>(i) * metrics;
    if (!IsUsable(answers[i])) {
      ++differences.failed;
    } else if (uncovered.contains(static_cast<int>(i))) {
      ++differences.uncovered;
    } else {
      for (int m = 0; m < metrics; ++m) {
        differences.of_metrics[static_cast<std::size_t>(m)].push_back(
            std::abs(mapped.values(first + m) - answers[i].values[m]));
      }
    }
  }
  return differences;
}

v1::MapVerification ToMessage(const v1::EvaluateMapResponse& mapped, Differences differences,
                              std::size_t points, std::int64_t seed) {
  v1::MapVerification verification;
  verification.set_points(static_cast<std::int64_t>(points));
  verification.set_failed(differences.failed);
  verification.set_uncovered(differences.uncovered);
  verification.set_seed(seed);
  for (int m = 0; m < mapped.metrics_size(); ++m) {
    std::vector<double>& values = differences.of_metrics[static_cast<std::size_t>(m)];
    if (values.empty()) continue;
    std::ranges::sort(values);
    v1::MapVerification::Difference& to = *verification.add_differences();
    to.set_metric(mapped.metrics(m));
    to.set_largest(values.back());
    const auto best =
        static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(values.size())));
    to.set_largest_99(values[best - 1]);
    double sum = 0;
    for (const double value : values) sum += value;
    to.set_mean(sum / static_cast<double>(values.size()));
  }
  return verification;
}

// Whether the evaluator is out of reach, rather than one of its designs at fault.
bool IsLost(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) ||
         absl::IsCancelled(status) || absl::IsAborted(status) || absl::IsPermissionDenied(status) ||
         absl::IsUnauthenticated(status);
}

absl::StatusOr<fields::DesignFields> FetchFields(MapEvaluator& evaluator, const std::string& file) {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, evaluator.Fetch(file));
  return fields::ReadFields(bytes);
}

// Compares the shapes of designs that the map has, one after the other: each file is as large as a
// mesh. An answer whose file is not to be had, or is none, becomes a failure.
absl::Status CompareShapes(const LoadedMap& map, const MapPoints& points, MapEvaluator& evaluator,
                           operations::OperationContext& context,
                           std::vector<DesignAnswer>& answers, ShapeVerification& comparison) {
  const Eigen::MatrixXd places = UnitPlaces(map.record, points.points);
  std::int64_t done = 0;
  for (const std::size_t i : comparison.OrderByMesh(points.structures, places)) {
    if (context.Cancelled()) return absl::CancelledError("given up");
    ++done;
    if (!IsUsable(answers[i])) continue;
    const auto truth = FetchFields(evaluator, answers[i].file);
    if (!truth.ok()) {
      if (IsLost(truth.status())) return truth.status();
      answers[i].status = truth.status();
      continue;
    }
    MORTISE_RETURN_IF_ERROR(
        comparison.Compare(points.structures[i], places.col(static_cast<Eigen::Index>(i)), *truth)
            .status());
    context.ReportProgress({.done = done, .total = static_cast<std::int64_t>(answers.size())});
  }
  return absl::OkStatus();
}

// Writes it into the map, which may have new tags or be gone by now. Returns the map.
absl::StatusOr<v1::DesignMap> Store(operations::OperationContext& context, const std::string& name,
                                    v1::MapVerification verification) {
  v1::DesignMap map;
  MORTISE_RETURN_IF_ERROR(context.Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(map, kMaps.Get(transaction, name));
    *map.mutable_verification() = verification;
    *map.mutable_verification()->mutable_create_time() =
        google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
            absl::ToUnixMicros(transaction.Now()));
    MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, kMaps.names, "name"));
    MORTISE_RETURN_IF_ERROR(transaction.Put(kMaps.kind, id, map.SerializeAsString()).status());
    return transaction.AppendEvent(
        {.type = "map.updated", .subject = name, .payload = "{}", .trace_id = CurrentTraceId()});
  }));
  return map;
}

}  // namespace

absl::StatusOr<std::string> RunVerifyOperation(rpc::ServiceEnvironment& environment,
                                               LoadedMaps& loaded, LoadedShapes& shapes,
                                               operations::OperationContext& context) {
  v1::VerifyMapRequest request;
  if (!request.ParseFromString(context.request())) {
    return StorageFailed(context.name(), "the stored request cannot be read");
  }
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const LoadedMap> map, loaded.Get(request.name()));
  if (request.points().empty()) {
    const int count = request.random_points() == 0 ? kDefaultVerified : request.random_points();
    *request.mutable_points() =
        RandomPoints(map->record, count, static_cast<std::uint64_t>(request.seed()));
  }
  MORTISE_ASSIGN_OR_RETURN(const MapPoints points,
                           ReadPoints(map->record, request.points(), kMaxVerified));
  const v1::MapSpecification& specification = map->record.specification();
  MORTISE_ASSIGN_OR_RETURN(const auto evaluator,
                           MapEvaluator::Create(environment, specification, context.stop_token()));
  const std::stop_callback interrupt(context.stop_token(), [&] { evaluator->Interrupt(); });
  MORTISE_ASSIGN_OR_RETURN(const MapPlan plan, MakePlan(specification, evaluator->described()));
  std::vector<Eigen::VectorXd> designs;
  for (const auto& point : points.points.colwise()) designs.push_back(plan.DesignOf(point));
  context.ReportProgress({.done = 0, .total = static_cast<std::int64_t>(designs.size())});
  MORTISE_ASSIGN_OR_RETURN(std::vector<DesignAnswer> answers, evaluator->Evaluate(designs));
  v1::EvaluateMapRequest asked;
  *asked.mutable_points() = request.points();
  MORTISE_ASSIGN_OR_RETURN(const v1::EvaluateMapResponse mapped,
                           Evaluate(*map, asked, [&] { return context.Cancelled(); }));
  std::optional<ShapeVerification> of_shapes;
  if (!map->shapes.empty()) {
    of_shapes.emplace(*map, shapes);
    MORTISE_RETURN_IF_ERROR(CompareShapes(*map, points, *evaluator, context, answers, *of_shapes));
  }
  v1::MapVerification verification =
      ToMessage(mapped, Compare(mapped, answers), designs.size(), request.seed());
  if (of_shapes) of_shapes->Report(verification);
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap verified,
                           Store(context, request.name(), std::move(verification)));
  return rpc::PackResult(verified);
}

}  // namespace mortise::interpolator
