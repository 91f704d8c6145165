#include "services/interpolator/service/build_operation.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/operation_codec.h"
#include "common/store/blob_folder.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/building/map_building.h"
#include "services/interpolator/records/kept_answers.h"
#include "services/interpolator/records/kept_noise.h"
#include "services/interpolator/records/kept_shapes.h"
#include "services/interpolator/records/map_files.h"
#include "services/interpolator/records/stored_map.h"
#include "services/interpolator/service/map_evaluator.h"
#include "services/interpolator/service/map_message.h"
#include "services/interpolator/service/map_records.h"
#include "services/interpolator/service/plan_request.h"
#include "services/interpolator/service/shapes_message.h"

namespace mortise::interpolator {
namespace {

// Some sixty designs at once keep a dozen workers busy; few in a call show their answers early.
constexpr int kLanes = 16;
constexpr int kBatch = 4;
// Of which all must have failed before the subject itself is suspected.
constexpr std::int64_t kSuspicious = 8;

// Rounds of more points keep more workers busy, of fewer choose better: a sixteenth of a
// structure's evaluations in each does both.
constexpr int kRounds = 16;
constexpr int kLeastRound = 8;
constexpr int kMostRound = 64;

maps::MapSamplingOptions SamplingOf(const v1::MapSpecification& specification,
                                    const MapPlan& plan) {
  maps::MapSamplingOptions options;
  options.basis = specification.basis() == v1::MapSpecification::CUBIC ? maps::Basis::kCubic
                                                                       : maps::Basis::kLinear;
  options.tolerance = specification.tolerance();
  for (const PlannedMetric& metric : plan.metrics) {
    options.noise_floor.push_back(metric.noise_floor);
  }
  options.seed = static_cast<std::uint64_t>(specification.seed());
  options.errors_from_outside = specification.has_shape();
  const auto structures = static_cast<int>(plan.structures.cols());
  options.round_points =
      std::clamp(plan.evaluations / structures / kRounds, kLeastRound, kMostRound);
  return options;
}

class BuildRun {
 public:
  BuildRun(rpc::ServiceEnvironment& environment, DiskQuota& quota,
           operations::OperationContext& context)
      : environment_(environment),
        context_(context),
        id_(context.name().substr(context.name().rfind('/') + 1)),
        disk_(&quota) {}

  absl::StatusOr<std::string> Run() {
    // An earlier run may have written the map and died before it could say so.
    const absl::StatusOr<v1::DesignMap> finished = kMaps.Get(*environment_.store, MapName());
    if (finished.ok()) return rpc::PackResult(*finished);
    if (!absl::IsNotFound(finished.status())) return finished.status();
    absl::StatusOr<std::string> result = Build();
    // What ends for good needs its answers no more; the simulator has them still.
    if (!result.ok() && !absl::IsAborted(result.status()) && !WillGoOn()) {
      MORTISE_RETURN_IF_ERROR(context_.Transact(
          [this](store::Transaction& transaction) { return DropKept(transaction); }));
    }
    return result;
  }

  const std::string& subject() const { return request_.specification().subject(); }

 private:
  absl::StatusOr<std::string> Build() {
    if (!request_.ParseFromString(context_.request())) {
      return StorageFailed(context_.name(), "the stored request cannot be read");
    }
    const v1::MapSpecification& specification = request_.specification();
    MORTISE_ASSIGN_OR_RETURN(blobs_, environment_.store->Blobs());
    MORTISE_ASSIGN_OR_RETURN(
        evaluator_, MapEvaluator::Create(environment_, specification, context_.stop_token()));
    MORTISE_ASSIGN_OR_RETURN(plan_, MakePlan(specification, evaluator_->described()));
    BuildOptions options = MakeOptions();
    if (EstimatesNoise(specification, plan_)) {
      MORTISE_ASSIGN_OR_RETURN(options.noise, MakeNoiseOptions());
    }
    MORTISE_ASSIGN_OR_RETURN(const auto building, MapBuilding::Create(plan_, options));
    MORTISE_ASSIGN_OR_RETURN(const KeptAnswers kept, LoadAnswers(*environment_.store, id_));
    for (const auto& [file, design] : kept.designs) evaluator_->Remember(file, design);
    MORTISE_ASSIGN_OR_RETURN(KnownShapes shapes, LoadShapes(*environment_.store, id_));
    MORTISE_RETURN_IF_ERROR(CountKnown(shapes));
    MORTISE_RETURN_IF_ERROR(building->Run(kept.answers, std::move(shapes)));
    return Finish(*building);
  }

  absl::Status DropKept(store::Transaction& transaction) const {
    MORTISE_RETURN_IF_ERROR(DropShapes(transaction, id_));
    MORTISE_RETURN_IF_ERROR(DropNoise(transaction, id_));
    return DropAnswers(transaction, id_);
  }

  // The disk that an earlier run has taken.
  absl::Status CountKnown(const KnownShapes& known) {
    for (const auto& [key, mesh] : known.meshes) {
      MORTISE_RETURN_IF_ERROR(disk_.TakeFile(mesh.digest, mesh.bytes));
    }
    for (const auto& [key, shape] : known.shapes) {
      MORTISE_RETURN_IF_ERROR(disk_.TakeFile(shape.digest, shape.bytes));
    }
    return absl::OkStatus();
  }

  // Whether another run takes this one's place: it was stopped by a shutdown or a takeover, and by
  // nobody who wants it to end. An operation that cannot be read is taken to be such.
  bool WillGoOn() const {
    if (!context_.Cancelled()) return false;
    const absl::StatusOr<operations::Operation> operation =
        environment_.operations->Get(context_.name());
    return !operation.ok() || !operation->cancel_requested;
  }

  BuildOptions MakeOptions() {
    BuildOptions options;
    options.sampling = SamplingOf(request_.specification(), plan_);
    options.lanes = kLanes;
    options.batch_size = kBatch;
    options.evaluate = [this](const std::vector<Eigen::VectorXd>& designs) {
      return evaluator_->Evaluate(designs);
    };
    options.interrupt = [this] {
      evaluator_->Interrupt();
      if (on_other_meshes_) on_other_meshes_->Interrupt();
    };
    options.cancelled = [this] { return context_.Cancelled(); };
    if (request_.specification().seconds() > 0) {
      // From when it was asked for, so that a restart gives it no more.
      const absl::Time end =
          context_.operation().created_at + absl::Seconds(request_.specification().seconds());
      options.is_out_of_time = [end] { return absl::Now() >= end; };
    }
    options.keep = [this](const KnownAnswers& answers) {
      return context_.Transact([&](store::Transaction& transaction) {
        return PutAnswers(transaction, id_, answers, [this](const std::string& file) {
          return evaluator_->DesignOf(file).value_or(Eigen::VectorXd());
        });
      });
    };
    if (request_.specification().has_shape()) options.shapes = MakeShapeOptions();
    options.progress = [this](const BuildProgress& progress) { Tell(progress); };
    options.judge = [this](const BuildProgress& progress) { return Judge(progress); };
    options.waiting = [this](std::chrono::seconds waited) { TellOfWaiting(waited); };
    return options;
  }

  absl::StatusOr<MeshNoiseOptions> MakeNoiseOptions() {
    MeshNoiseOptions options = NoiseWantedOf(request_.specification());
    MORTISE_ASSIGN_OR_RETURN(options.known, LoadNoise(*environment_.store, id_));
    if (options.known) return options;
    MORTISE_ASSIGN_OR_RETURN(
        on_other_meshes_,
        MapEvaluator::Create(environment_, OnOtherMeshes(request_.specification()),
                             context_.stop_token()));
    options.evaluate = [this](const Eigen::VectorXd& design) -> absl::StatusOr<DesignAnswer> {
      MORTISE_ASSIGN_OR_RETURN(std::vector<DesignAnswer> answers,
                               on_other_meshes_->Evaluate({design}));
      return std::move(answers.front());
    };
    options.get = [this](const std::string& file) { return on_other_meshes_->Fetch(file); };
    options.keep = [this](const MeshNoise& noise) {
      return context_.Transact(
          [&](store::Transaction& transaction) { return PutNoise(transaction, id_, noise); });
    };
    return options;
  }

  ShapeOptions MakeShapeOptions() {
    const v1::MapSpecification::ShapeChoice& wanted = request_.specification().shape();
    ShapeOptions options;
    for (const auto& field : wanted.fields()) {
      options.fields.push_back({field.name(), field.noise_floor()});
    }
    options.noise_floor = wanted.noise_floor();
    options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    options.put = [this](const std::string& bytes) { return PutFile(*blobs_, disk_, bytes); };
    options.get = [this](const std::string& digest) {
      // What the evaluator gave is with the simulator, what came of it is here.
      return evaluator_->DesignOf(digest) ? evaluator_->Fetch(digest) : blobs_->Get(digest);
    };
    options.keep = [this](const KnownShapes& known) {
      return context_.Transact(
          [&](store::Transaction& transaction) { return PutShapes(transaction, id_, known); });
    };
    return options;
  }

  // Whether the map would have a value anywhere, and a shape where it is to have such.
  bool Answers(const std::vector<maps::MapContent>& contents,
               const std::vector<ShapedStructure>& shaped) const {
    if (request_.specification().has_shape()) {
      return std::ranges::any_of(
          shaped, [](const ShapedStructure& structure) { return !structure.meshes.empty(); });
    }
    return std::ranges::any_of(contents, [](const maps::MapContent& content) {
      return std::ranges::count(content.cut_off, 0) > 0;
    });
  }

  absl::Status Empty(const BuildProgress& progress) const {
    std::string why = absl::StrCat("of ", progress.evaluations, " designs of ", subject(),
                                   " too few could be evaluated for a map");
    if (progress.unmapped > 0) absl::StrAppend(&why, " and share a mesh with those around them");
    const char* before = ": ";
    for (const auto* failures : {&progress.failures, &progress.unmapped_failures}) {
      if (failures->empty()) continue;
      absl::StrAppend(&why, before, evaluation::CountsWithExamples(*failures));
      before = "; ";
    }
    return PreconditionFailed("MAP_EMPTY", why, subject());
  }

  void Tell(const BuildProgress& progress) {
    told_.done = progress.evaluations;
    told_.total = plan_.evaluations;
    told_.best_so_far = progress.error;
    told_.has_best = progress.is_measured;
    told_.message = progress.is_measured
                        ? absl::StrFormat("error %.3g of the range, %d elements", progress.error,
                                          progress.elements)
                        : absl::StrFormat("error not measured yet, %d elements", progress.elements);
    if (request_.specification().has_shape()) {
      absl::StrAppend(&told_.message, ", ", progress.shapes, " shapes in ", progress.meshes,
                      progress.meshes == 1 ? " mesh" : " meshes");
      if (progress.to_map > 0) absl::StrAppend(&told_.message, ", ", progress.to_map, " to map");
      if (progress.unmapped > 0) {
        absl::StrAppend(&told_.message, ", ", progress.unmapped, " in no mesh (",
                        evaluation::CountsByReason(progress.unmapped_failures), ")");
      }
    }
    if (progress.failed > 0) {
      absl::StrAppend(&told_.message, ", ", progress.failed, " failed (",
                      evaluation::CountsByReason(progress.failures), ")");
    }
    context_.ReportProgress(told_);
  }

  void TellOfWaiting(std::chrono::seconds waited) {
    operations::Progress progress = told_;
    progress.message = absl::StrCat("waiting for ", subject(), ": no answer for ", waited.count(),
                                    " s; its workers may be busy or not running");
    if (!told_.message.empty()) absl::StrAppend(&progress.message, "; until then ", told_.message);
    context_.ReportProgress(progress);
  }

  // Ends a build in which every design must fail, as all have so far, and the default one does.
  absl::Status Judge(const BuildProgress& progress) {
    if (progress.evaluations < kSuspicious || progress.failed < progress.evaluations) {
      return absl::OkStatus();
    }
    const auto suspected = std::ranges::find_if(progress.failures, evaluation::MayBeOfSubject);
    if (suspected == progress.failures.end()) return absl::OkStatus();
    if (!default_design_) {
      const std::stop_callback interrupt(context_.stop_token(),
                                         [this] { evaluator_->Interrupt(); });
      auto answers = evaluator_->Evaluate({plan_.base});
      // An evaluator that is away is asked again after the next batch.
      if (!answers.ok()) return absl::OkStatus();
      default_design_ = std::move(answers->front());
    }
    if (default_design_->status.ok() || default_design_->status.code() != suspected->code ||
        default_design_->status.message() != suspected->message) {
      return absl::OkStatus();
    }
    return PreconditionFailed(
        "SUBJECT_UNUSABLE",
        absl::StrCat("no design of ", subject(), " can be evaluated. The default one and ",
                     suspected->count, " of the first ", progress.evaluations,
                     ", which all failed, say: ", suspected->message, " (", suspected->reason, ")"),
        subject());
  }

  absl::StatusOr<std::string> Finish(const MapBuilding& building) {
    const bool is_stopped = context_.Cancelled();
    if (is_stopped && WillGoOn()) return absl::CancelledError("interrupted");
    const BuildProgress progress = building.progress();
    std::vector<maps::MapContent> contents;
    for (const auto& structure : building.structures()) {
      absl::StatusOr<maps::MapContent> content = structure->Content();
      if (content.ok()) contents.push_back(*std::move(content));
    }
    const bool is_known = contents.size() == building.structures().size();
    if (is_stopped && !is_known) return absl::CancelledError("cancelled before there was a map");
    if (!is_known) return Empty(progress);
    MORTISE_ASSIGN_OR_RETURN(const std::vector<ShapedStructure> shaped, ShapesOf(building));
    if (!Answers(contents, shaped)) return Empty(progress);
    MORTISE_ASSIGN_OR_RETURN(const std::string packed, StoreMap(building, contents, shaped));
    if (is_stopped) {
      context_.KeepResult(packed);
      return absl::CancelledError("cancelled; the map holds what was sampled by then");
    }
    // It may end before all that it was allowed to evaluate: then it is through with fewer.
    told_.total = told_.done = progress.evaluations;
    context_.ReportProgress(told_);
    return packed;
  }

  // What the structures have of shapes; none of a map without.
  absl::StatusOr<std::vector<ShapedStructure>> ShapesOf(const MapBuilding& building) const {
    std::vector<ShapedStructure> shapes;
    for (std::size_t s = 0; s < building.structures().size(); ++s) {
      MORTISE_ASSIGN_OR_RETURN(std::optional<ShapedStructure> of_structure, building.ShapesOf(s));
      if (of_structure) shapes.push_back(*std::move(of_structure));
    }
    return shapes;
  }

  // The map, packed.
  absl::StatusOr<std::string> StoreMap(const MapBuilding& building,
                                       const std::vector<maps::MapContent>& contents,
                                       const std::vector<ShapedStructure>& shaped) {
    const std::int64_t of_shapes = BytesOf(shaped);
    const v1::MapShapes shapes =
        MakeShapes(request_.specification(), shaped, building.noise(), of_shapes);
    std::vector<StoredShapes> stored;
    for (const ShapedStructure& structure : shaped) stored.push_back(ToStored(structure, shapes));
    const std::string bytes = SerializeMap(contents, stored);
    // What is not to be read again is never stored.
    MORTISE_ASSIGN_OR_RETURN(const std::vector<StoredStructure> structures, ParseMap(bytes));
    v1::DesignMap map = MakeMap(request_.specification(), plan_, building, structures);
    map.set_name(MapName());
    rpc::SetTagsAndCreator(context_.operation(), &map);
    MORTISE_ASSIGN_OR_RETURN(const std::string digest, PutFile(*blobs_, disk_, bytes));
    map.set_sha256(digest);
    map.set_bytes(static_cast<std::int64_t>(bytes.size()) + of_shapes);
    if (!shaped.empty()) map.mutable_shapes()->MergeFrom(shapes);
    MORTISE_RETURN_IF_ERROR(context_.Transact(
        [&](store::Transaction& transaction) { return PutMap(transaction, stored, map); }));
    return rpc::PackResult(map);
  }

  // The map in the place of what was kept for it, all at once.
  absl::Status PutMap(store::Transaction& transaction, const std::vector<StoredShapes>& shapes,
                      v1::DesignMap& map) const {
    *map.mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
        absl::ToUnixMicros(transaction.Now()));
    MORTISE_RETURN_IF_ERROR(transaction.Put(kMaps.kind, id_, map.SerializeAsString()).status());
    if (!shapes.empty()) MORTISE_RETURN_IF_ERROR(PutMapFiles(transaction, id_, shapes));
    MORTISE_RETURN_IF_ERROR(DropKept(transaction));
    return transaction.AppendEvent({.type = "map.created",
                                    .subject = map.name(),
                                    .payload = "{}",
                                    .trace_id = CurrentTraceId()});
  }

  std::string MapName() const { return absl::StrCat(kMaps.names, "/", id_); }

  rpc::ServiceEnvironment& environment_;
  operations::OperationContext& context_;
  const std::string id_;
  DiskQuota::Build disk_;
  store::BlobFolder* blobs_ = nullptr;
  v1::BuildMapRequest request_;
  MapPlan plan_;
  std::unique_ptr<MapEvaluator> evaluator_;
  std::unique_ptr<MapEvaluator> on_other_meshes_;  // where noise is to be estimated
  operations::Progress told_;                      // last
  std::optional<DesignAnswer> default_design_;     // what became of it, once it was tried
};

}  // namespace

absl::StatusOr<std::string> RunBuildOperation(
    rpc::ServiceEnvironment& environment, DiskQuota& quota, operations::OperationContext& context,
    const std::function<void(const std::string& subject)>& stored) {
  BuildRun run(environment, quota, context);
  absl::StatusOr<std::string> result = run.Run();
  if (!run.subject().empty()) stored(run.subject());
  return result;
}

}  // namespace mortise::interpolator
