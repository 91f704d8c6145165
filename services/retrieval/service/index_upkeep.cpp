#include "services/retrieval/service/index_upkeep.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/store/store.h"
#include "mortise/v1/events.grpc.pb.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

constexpr absl::Duration kReconnectAfter = absl::Seconds(2);
constexpr absl::Duration kListTimeout = absl::Seconds(30);
constexpr absl::Duration kLookAgainAfter = absl::Seconds(1);  // while an index is built
constexpr int kMaxDoublings = 10;                             // of that

Revisions RevisionsOf(const v1::ShapeIndex& index) {
  Revisions revisions;
  for (const v1::ShapeIndex::Family& family : index.families()) {
    revisions[family.template_()] = family.template_revision();
  }
  return revisions;
}

// Whether an index has the templates that it is kept up to as they are.
bool IsCurrent(const v1::ShapeIndex& index, const Revisions& present) {
  const auto descriptor = MakeDescriptor(IndexIdOf(index.shape_descriptor()));
  if (!descriptor.ok() || !IsOfThisVersion(index, **descriptor)) return false;
  const Revisions covered = RevisionsOf(index);
  if (index.every_template()) return covered == present;
  return std::all_of(covered.begin(), covered.end(), [&present](const auto& family) {
    const auto found = present.find(family.first);
    return found != present.end() && found->second == family.second;
  });
}

absl::StatusOr<std::vector<v1::ShapeIndex>> AllIndexes(store::ReadTransaction& transaction) {
  std::vector<v1::ShapeIndex> indexes;
  for (const v1::ShapeDescriptor descriptor : AllShapeDescriptors()) {
    const absl::StatusOr<store::Record> record =
        transaction.Get(kIndexes.kind, IndexIdOf(descriptor));
    if (absl::IsNotFound(record.status())) continue;
    MORTISE_RETURN_IF_ERROR(record.status());
    MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index,
                             resources::ParseRecord<v1::ShapeIndex>(kIndexes.kind, *record));
    indexes.push_back(std::move(index));
  }
  return indexes;
}

absl::StatusOr<bool> IsBuilding(operations::Operations& operations) {
  bool is_building = false;
  MORTISE_RETURN_IF_ERROR(operations.Visit(
      "",
      {.states = {operations::OperationState::kPending, operations::OperationState::kRunning},
       .kind = operations::kIndexOperation},
      [&is_building]() -> operations::Operations::Visitor {
        is_building = false;
        return [&is_building](const operations::Operation&) {
          is_building = true;
          return false;
        };
      }));
  return is_building;
}

absl::Status SayNotCurrent(store::Transaction& transaction, v1::ShapeIndex index) {
  if (!index.current()) return absl::OkStatus();
  index.set_current(false);
  return PutIndex(transaction, index, "");
}

}  // namespace

IndexUpkeep::IndexUpkeep(rpc::ServiceEnvironment& environment,
                         std::shared_ptr<grpc::Channel> catalog, const TemplateSource& templates)
    : environment_(environment),
      catalog_(std::move(catalog)),
      templates_(templates),
      follower_([this](const std::stop_token& stop) { Follow(stop); }),
      checker_([this](const std::stop_token& stop) { Check(stop); }) {}

IndexUpkeep::~IndexUpkeep() {
  follower_.request_stop();
  checker_.request_stop();
}

rpc::Origin IndexUpkeep::Origin(absl::Duration timeout) const {
  return rpc::OwnOrigin(environment_.signer, rpc::Role::kViewer, "", timeout);
}

void IndexUpkeep::Notice() {
  {
    const std::lock_guard lock(mutex_);
    has_news_ = true;
  }
  noticed_.notify_all();
}

void IndexUpkeep::Follow(const std::stop_token& stop) {
  const auto stub = v1::EventService::NewStub(catalog_);
  v1::FollowEventsRequest request;
  request.add_streams("catalog");
  request.set_after_number(-1);
  request.add_type_prefixes("template.");
  do {
    const std::unique_ptr<grpc::ClientContext> context =
        rpc::MakeClientContext(Origin(absl::InfiniteDuration()));
    const std::stop_callback stopping(stop, [&context] { context->TryCancel(); });
    const auto events = stub->FollowEvents(context.get(), request);
    Notice();  // of what has happened since it was last followed
    for (v1::Event event; events->Read(&event);) Notice();
    events->Finish().IgnoreError();
  } while (rpc::Pause(kReconnectAfter, stop));
}

void IndexUpkeep::Check(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      if (!noticed_.wait(lock, stop, [this] { return has_news_; })) return;
      has_news_ = false;
    }
    const absl::StatusOr<bool> is_settled = BringUp();
    if (!is_settled.ok() && !absl::IsUnavailable(is_settled.status())) {
      Log(LogLevel::kWarning, "indexes cannot be compared with the templates",
          {{"error", is_settled.status().message()}});
    }
    if (is_settled.ok() && *is_settled) continue;
    // A build that fails again and again is started ever more seldom.
    const absl::Duration wait = kLookAgainAfter * std::exp2(std::min(starts_, kMaxDoublings));
    if (!rpc::Pause(wait, stop)) return;
    Notice();
  }
}

// Whether nothing is left to be done. An index that is being built may miss what came meanwhile.
absl::StatusOr<bool> IndexUpkeep::BringUp() {
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<v1::ShapeIndex> indexes,
      resources::ReadFrom<std::vector<v1::ShapeIndex>>(*environment_.store, AllIndexes));
  if (indexes.empty()) return true;
  MORTISE_ASSIGN_OR_RETURN(const bool is_building, IsBuilding(*environment_.operations));
  if (is_building) return false;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Template> templates,
                           templates_.List({}, Origin(kListTimeout)));
  Revisions present;
  for (const v1::Template& each : templates) present[each.name()] = each.revision();
  // Somebody who cancels a build does not want it again: until a template changes, or they ask.
  std::set<v1::ShapeDescriptor> given_up;
  for (const v1::ShapeIndex& index : indexes) {
    MORTISE_ASSIGN_OR_RETURN(const bool is_given_up, IsGivenUp(*environment_.operations,
                                                               index.shape_descriptor(), present));
    if (is_given_up) given_up.insert(index.shape_descriptor());
  }
  bool is_settled = true;
  MORTISE_RETURN_IF_ERROR(
      environment_.store->Transact([&](store::Transaction& transaction) -> absl::Status {
        is_settled = true;
        MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::ShapeIndex> now, AllIndexes(transaction));
        // One build for all that are kept up to the same: they share designs.
        std::map<bool, v1::BuildIndexRequest> requests;  // by whether they are of every template
        for (const v1::ShapeIndex& index : now) {
          if (IsCurrent(index, present) || given_up.contains(index.shape_descriptor())) continue;
          is_settled = false;
          requests[index.every_template()].add_shape_descriptors(index.shape_descriptor());
          MORTISE_RETURN_IF_ERROR(SayNotCurrent(transaction, index));
        }
        for (auto& [of_every_template, request] : requests) {
          request.set_refresh(!of_every_template);
          MORTISE_RETURN_IF_ERROR(StartBuild(transaction, request, present));
        }
        return absl::OkStatus();
      }));
  starts_ = is_settled ? 0 : starts_ + 1;
  return is_settled;
}

absl::Status IndexUpkeep::StartBuild(store::Transaction& transaction,
                                     const v1::BuildIndexRequest& request,
                                     const Revisions& present) {
  return environment_.operations
      ->Start(transaction, {.kind = operations::kIndexOperation,
                            .request = request.SerializeAsString(),
                            .subject = "indexes",
                            .creator = kUpkeepCreator,
                            .tags = TagsOf(present)})
      .status();
}

}  // namespace mortise::retrieval
