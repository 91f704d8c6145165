#include "services/interpolator/service/map_upkeep.h"

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/evaluation/described_design_space.h"
#include "common/host/unused_files.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "services/interpolator/records/map_files.h"
#include "services/interpolator/service/interpolator.h"
#include "services/interpolator/service/map_records.h"

namespace mortise::interpolator {
namespace {

constexpr absl::Duration kReconnectAfter = absl::Seconds(2);
constexpr absl::Duration kDescribeTimeout = absl::Seconds(30);
constexpr std::chrono::hours kPause{1};
constexpr int kPage = 1000;

// Shows each map to `visit`.
template <typename Visit>
absl::Status VisitMaps(store::ReadTransaction& transaction, const Visit& visit) {
  store::ListOptions list;
  list.limit = kPage;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                             transaction.List(kMaps.kind, list));
    for (const store::Record& record : page) {
      MORTISE_ASSIGN_OR_RETURN(v1::DesignMap map,
                               resources::ParseRecord<v1::DesignMap>(kMaps.kind, record));
      MORTISE_RETURN_IF_ERROR(visit(record.key, std::move(map)));
    }
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<StaleUpkeep>> StaleUpkeep::Start(
    rpc::ServiceEnvironment& environment) {
  MORTISE_ASSIGN_OR_RETURN(auto catalog, environment.peers->Channel("catalog"));
  MORTISE_ASSIGN_OR_RETURN(auto simulator, environment.peers->Channel(kEvaluatorPeer));
  return std::unique_ptr<StaleUpkeep>(
      new StaleUpkeep(environment, std::move(catalog), std::move(simulator)));
}

StaleUpkeep::StaleUpkeep(rpc::ServiceEnvironment& environment,
                         std::shared_ptr<grpc::Channel> catalog,
                         std::shared_ptr<grpc::Channel> simulator)
    : environment_(environment),
      catalog_(std::move(catalog)),
      simulator_(std::move(simulator)),
      catalog_follower_(
          [this](const std::stop_token& stop) { Follow(stop, catalog_, "catalog", "template."); }),
      simulator_follower_([this](const std::stop_token& stop) {
        Follow(stop, simulator_, "simulator", "evaluator.");
      }),
      checker_([this](const std::stop_token& stop) { Check(stop); }) {}

StaleUpkeep::~StaleUpkeep() {
  catalog_follower_.request_stop();
  simulator_follower_.request_stop();
  checker_.request_stop();
}

rpc::Origin StaleUpkeep::Origin(absl::Duration timeout) const {
  return rpc::OwnOrigin(environment_.signer, rpc::Role::kViewer, "", timeout);
}

void StaleUpkeep::Notice(const std::set<std::string>& subjects) {
  {
    const std::lock_guard lock(mutex_);
    subjects_.insert(subjects.begin(), subjects.end());
  }
  noticed_.notify_all();
}

// Of all that there are maps of that are not stale yet.
absl::Status StaleUpkeep::NoticeAll() {
  std::set<std::string> subjects;
  MORTISE_RETURN_IF_ERROR(
      environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
        subjects.clear();
        return VisitMaps(transaction, [&](const std::string&, const v1::DesignMap& map) {
          if (!map.stale()) subjects.insert(map.specification().subject());
          return absl::OkStatus();
        });
      }));
  Notice(subjects);
  return absl::OkStatus();
}

void StaleUpkeep::Follow(const std::stop_token& stop, const std::shared_ptr<grpc::Channel>& channel,
                         const std::string& stream, const std::string& types) {
  const auto stub = v1::EventService::NewStub(channel);
  v1::FollowEventsRequest request;
  request.add_streams(stream);
  request.set_after_number(-1);
  request.add_type_prefixes(types);
  do {
    const std::unique_ptr<grpc::ClientContext> context =
        rpc::MakeClientContext(Origin(absl::InfiniteDuration()));
    const std::stop_callback stopping(stop, [&context] { context->TryCancel(); });
    const auto events = stub->FollowEvents(context.get(), request);
    // What has happened since it was last followed.
    if (const absl::Status noticed = NoticeAll(); !noticed.ok()) {
      Log(LogLevel::kWarning, "maps cannot be read", {{"error", noticed.message()}});
    }
    for (v1::Event event; events->Read(&event);) Notice({event.subject()});
    events->Finish().IgnoreError();
  } while (rpc::Pause(kReconnectAfter, stop));
}

void StaleUpkeep::Check(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::string subject;
    {
      std::unique_lock lock(mutex_);
      if (!noticed_.wait(lock, stop, [this] { return !subjects_.empty(); })) return;
      subject = *subjects_.begin();
      subjects_.erase(subjects_.begin());
    }
    const absl::Status checked = CheckSubject(subject);
    if (checked.ok() || absl::IsUnavailable(checked)) continue;
    Log(LogLevel::kWarning, "maps cannot be compared with their subject",
        {{"subject", subject}, {"error", checked.message()}});
  }
}

// An evaluator that is away is asked when it is followed again.
absl::Status StaleUpkeep::CheckSubject(const std::string& subject) {
  std::vector<std::string> current;  // ids
  MORTISE_RETURN_IF_ERROR(
      environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
        current.clear();
        return VisitMaps(transaction, [&](const std::string& id, const v1::DesignMap& map) {
          if (!map.stale() && map.specification().subject() == subject) current.push_back(id);
          return absl::OkStatus();
        });
      }));
  if (current.empty()) return absl::OkStatus();
  v1::DescribeDesignSpaceRequest request;
  request.set_subject(subject);
  const auto described =
      evaluation::DescribeDesignSpace(simulator_, request, Origin(kDescribeTimeout), {});
  if (!described.ok() && !absl::IsNotFound(described.status())) return described.status();
  const std::int64_t latest = described.ok() ? (*described)->revision() : 0;
  return environment_.store->Transact([&](store::Transaction& transaction) -> absl::Status {
    for (const std::string& id : current) {
      const absl::StatusOr<store::Record> record = transaction.Get(kMaps.kind, id);
      if (absl::IsNotFound(record.status())) continue;
      MORTISE_RETURN_IF_ERROR(record.status());
      MORTISE_ASSIGN_OR_RETURN(v1::DesignMap map,
                               resources::ParseRecord<v1::DesignMap>(kMaps.kind, *record));
      if (map.stale() || map.specification().revision() == latest) continue;
      map.set_stale(true);
      MORTISE_RETURN_IF_ERROR(transaction.Put(kMaps.kind, id, map.SerializeAsString()).status());
      MORTISE_RETURN_IF_ERROR(transaction.AppendEvent(
          {.type = "map.updated", .subject = map.name(), .payload = "{}", .trace_id = ""}));
    }
    return absl::OkStatus();
  });
}

absl::StatusOr<std::int64_t> BytesOfMaps(store::Store& store) {
  std::int64_t bytes = 0;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    bytes = 0;
    return VisitMaps(transaction, [&](const std::string&, const v1::DesignMap& map) {
      bytes += map.bytes();
      return absl::OkStatus();
    });
  }));
  return bytes;
}

absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder) {
  rpc::NamedFiles files;
  files.by_store = [](store::ReadTransaction& read, std::set<std::string>* named) {
    MORTISE_RETURN_IF_ERROR(AddMapFiles(read, named));
    return VisitMaps(read, [named](const std::string&, const v1::DesignMap& map) {
      named->insert(map.sha256());
      return absl::OkStatus();
    });
  };
  return rpc::RemoveUnusedFiles(store, operations, folder, files);
}

FileUpkeep::FileUpkeep(const rpc::ServiceEnvironment& environment)
    : work_(kPause, [store = environment.store, operations = environment.operations,
                     folder = environment.options.blobs] {
        const auto removed = RemoveUnusedFiles(*store, *operations, folder);
        if (!removed.ok()) {
          Log(LogLevel::kWarning, "unused files could not be removed",
              {{"error", removed.status().ToString()}});
        } else if (removed->count > 0) {
          Log(LogLevel::kInfo, "removed files that nothing refers to",
              {{"files", removed->count}, {"bytes", removed->bytes}});
        }
      }) {}

}  // namespace mortise::interpolator
