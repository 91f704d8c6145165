#include "services/retrieval/service/cover_queue.h"

#include <chrono>
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/status_mapping.h"
#include "common/store/blob_folder.h"
#include "google/rpc/status.pb.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

constexpr int kPage = 100;
constexpr int kMaxAttempts = 5;
constexpr absl::Duration kAgainAfter = absl::Seconds(1);

bool HasEndedIn(const store::Task& task) {
  return task.state != store::TaskState::kQueued && task.state != store::TaskState::kLeased;
}

// The same task has the same key, also in another build.
std::string KeyOf(const v1::CoverTask& task) {
  std::string all = absl::StrCat(task.family().template_(), "\n", task.family().group());
  for (const v1::WantedCover& cover : task.covers()) absl::StrAppend(&all, "\n", cover.digest());
  return Sha256Hex(all);
}

absl::StatusOr<v1::CoverTask> TaskOf(const store::Task& stored) {
  v1::CoverTask task;
  if (!task.ParseFromString(stored.payload)) {
    return StorageFailed(absl::StrCat("tasks/", stored.key), "the task cannot be read");
  }
  return task;
}

// Calls `visit` with each task of the queue.
template <class Visit>
absl::Status VisitTasks(store::ReadTransaction& transaction, const Visit& visit) {
  store::ListOptions list{.limit = kPage};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Task> page,
                             transaction.ListTasks(kCoverQueue, list));
    for (const store::Task& task : page) MORTISE_RETURN_IF_ERROR(visit(task));
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

// Whether there is the cover that is wanted of a family.
absl::StatusOr<bool> IsThere(store::ReadTransaction& transaction,
                             const v1::ShapeIndex::Family& family, const v1::WantedCover& wanted,
                             bool also_faulty) {
  MORTISE_ASSIGN_OR_RETURN(const std::optional<v1::ShapeIndex> cover,
                           FindCover(transaction, IndexIdOf(wanted.shape_descriptor()),
                                     family.template_(), family.group()));
  return cover && cover->families(0).digest() == wanted.digest() &&
         (also_faulty || cover->families(0).fault().empty());
}

// Leaves out covers that an earlier attempt has made.
absl::Status LeaveOutWhatIsThere(store::ReadTransaction& transaction, v1::CoverTask* task) {
  if (task->anew()) return absl::OkStatus();
  google::protobuf::RepeatedPtrField<v1::WantedCover> missing;
  for (const v1::WantedCover& wanted : task->covers()) {
    MORTISE_ASSIGN_OR_RETURN(const bool is_there,
                             IsThere(transaction, task->family(), wanted, false));
    if (!is_there) *missing.Add() = wanted;
  }
  task->mutable_covers()->Swap(&missing);
  return absl::OkStatus();
}

// The cover that is wanted of the task's family, without its designs yet.
absl::StatusOr<v1::ShapeIndex> CoverOf(const v1::CoverTask& task, const v1::WantedCover& wanted) {
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Descriptor> descriptor,
                           MakeDescriptor(IndexIdOf(wanted.shape_descriptor())));
  v1::ShapeIndex cover =
      EmptyCover(wanted.shape_descriptor(), wanted.delta(), *descriptor, task.family());
  cover.mutable_families(0)->set_digest(wanted.digest());
  return cover;
}

}  // namespace

bool IsLost(const absl::Status& renewed) {
  return absl::IsAborted(renewed) || absl::IsFailedPrecondition(renewed) ||
         absl::IsNotFound(renewed);
}

CoverQueue::CoverQueue(store::Store* store, store::BlobFolder* blobs, rpc::Dispatcher* dispatcher)
    : store_(store), blobs_(blobs), idle_workers_(rpc::IdleWorkers::Create(dispatcher)) {}

absl::Status CoverQueue::Begin() {
  {
    const std::lock_guard lock(mutex_);
    ended_.clear();
  }
  return store_->Transact([](store::Transaction& transaction) -> absl::Status {
    std::set<std::string> ended, own;
    MORTISE_RETURN_IF_ERROR(VisitTasks(transaction, [&](const store::Task& task) {
      if (HasEndedIn(task)) ended.insert(task.key);
      const bool is_leased = task.state == store::TaskState::kLeased;
      if (is_leased && absl::StartsWith(task.worker, kOwnWorker)) own.insert(task.worker);
      return absl::OkStatus();
    }));
    for (const std::string& key : ended) {
      MORTISE_RETURN_IF_ERROR(transaction.DeleteTask(kCoverQueue, key));
    }
    for (const std::string& worker : own) {
      MORTISE_RETURN_IF_ERROR(transaction.ExpireLeases(kCoverQueue, worker).status());
    }
    return absl::OkStatus();
  });
}

absl::StatusOr<std::string> CoverQueue::Enqueue(const v1::CoverTask& task) {
  const std::string key = KeyOf(task);
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) {
    return transaction
        .EnqueueTasks({{.queue = kCoverQueue,
                        .key = key,
                        .payload = task.SerializeAsString(),
                        .max_attempts = kMaxAttempts}})
        .status();
  }));
  Tell(std::nullopt);
  return key;
}

absl::Status CoverQueue::CancelOthers(const std::set<std::string>& keys) {
  return store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    std::vector<std::string> others;
    MORTISE_RETURN_IF_ERROR(VisitTasks(transaction, [&](const store::Task& task) {
      if (!HasEndedIn(task) && !keys.contains(task.key)) others.push_back(task.key);
      return absl::OkStatus();
    }));
    for (const std::string& key : others) {
      MORTISE_RETURN_IF_ERROR(transaction.CancelTask(kCoverQueue, key));
    }
    return absl::OkStatus();
  });
}

absl::StatusOr<std::int64_t> CoverQueue::CountUnfinished() {
  // Whoever leases looks for leases that have run out; where nobody does, this does.
  std::vector<store::Task> put_aside;
  store::QueueDepth depth;
  absl::Status failure;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    failure = absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(store::LeaseResult result,
                             transaction.LeaseTasks(kCoverQueue, kOwnWorker, 0, absl::Seconds(1)));
    put_aside = std::move(result.quarantined);
    for (const store::Task& task : put_aside) {
      MORTISE_RETURN_IF_ERROR(PutAside(transaction, task));
    }
    MORTISE_ASSIGN_OR_RETURN(depth, transaction.Depth(kCoverQueue));
    if (depth.failed == 0) return absl::OkStatus();
    return VisitTasks(transaction, [&](const store::Task& task) {
      google::rpc::Status error;
      if (task.state == store::TaskState::kFailed && failure.ok()) {
        failure = error.ParseFromString(task.error) ? rpc::FromProto(error)
                                                    : absl::InternalError(task.error);
      }
      return absl::OkStatus();
    });
  }));
  for (const store::Task& task : put_aside) Tell(task.key);
  MORTISE_RETURN_IF_ERROR(failure);
  return depth.queued + depth.leased;
}

bool CoverQueue::HasEnded(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  return ended_.contains(key);
}

void CoverQueue::Tell(const std::optional<std::string>& ended) {
  {
    const std::lock_guard lock(mutex_);
    ++news_;
    if (ended) ended_.insert(*ended);
  }
  changed_.notify_all();
  if (!ended) idle_workers_->Wake();
}

void CoverQueue::Wait(absl::Duration timeout) {
  std::unique_lock lock(mutex_);
  const std::uint64_t before = news_;
  changed_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [&] { return news_ != before; });
}

// A family that ended its workers has that as the fault of its covers.
absl::Status CoverQueue::PutAside(store::Transaction& transaction, const store::Task& stored) {
  MORTISE_ASSIGN_OR_RETURN(v1::CoverTask task, TaskOf(stored));
  MORTISE_RETURN_IF_ERROR(LeaveOutWhatIsThere(transaction, &task));
  for (const v1::WantedCover& wanted : task.covers()) {
    MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex cover, CoverOf(task, wanted));
    cover.mutable_families(0)->set_fault(
        absl::StrCat("covering it ended ", stored.attempt, " workers without a report"));
    MORTISE_RETURN_IF_ERROR(PutCover(transaction, IndexIdOf(wanted.shape_descriptor()), cover));
  }
  Log(LogLevel::kError, "a template ended its workers and was put aside",
      {{"template", task.family().template_()}, {"worker", stored.worker}});
  return absl::OkStatus();
}

absl::StatusOr<std::optional<v1::CoverTask>> CoverQueue::Lease(const std::string& worker,
                                                               absl::Duration lease) {
  std::optional<v1::CoverTask> leased;
  std::vector<store::Task> put_aside;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    leased.reset();
    MORTISE_ASSIGN_OR_RETURN(store::LeaseResult result,
                             transaction.LeaseTasks(kCoverQueue, worker, 1, lease));
    put_aside = std::move(result.quarantined);
    for (const store::Task& task : put_aside) {
      MORTISE_RETURN_IF_ERROR(PutAside(transaction, task));
    }
    if (result.leased.empty()) return absl::OkStatus();
    const store::Task& stored = result.leased.front();
    MORTISE_ASSIGN_OR_RETURN(leased, TaskOf(stored));
    const v1::WantedCover last = leased->covers(leased->covers_size() - 1);
    MORTISE_RETURN_IF_ERROR(LeaveOutWhatIsThere(transaction, &*leased));
    // By the report of which the task ends.
    if (leased->covers().empty()) *leased->add_covers() = last;
    leased->set_name(absl::StrCat("tasks/", stored.key));
    leased->set_attempt(static_cast<int>(stored.attempt));
    return absl::OkStatus();
  }));
  for (const store::Task& task : put_aside) Tell(task.key);
  return leased;
}

absl::Status CoverQueue::Renew(const std::string& key, std::int64_t attempt, absl::Duration lease) {
  return store_->Transact(
      [&](store::Transaction& transaction) {
        return transaction.RenewLease(kCoverQueue, key, attempt, lease);
      },
      store::Isolation::kReadCommitted);
}

// The cover as it is kept; its file has been looked at.
absl::StatusOr<v1::ShapeIndex> CoverQueue::RecordOf(const v1::CoverTask& task,
                                                    const v1::MadeCover& made) const {
  const v1::WantedCover* wanted = nullptr;
  for (const v1::WantedCover& each : task.covers()) {
    const bool is_it = each.shape_descriptor() == made.shape_descriptor();
    if (is_it && each.digest() == made.digest()) wanted = &each;
  }
  if (wanted == nullptr) return InvalidField("cover.digest", "is of no cover that was asked for");
  MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex record, CoverOf(task, *wanted));
  v1::ShapeIndex::Family& family = *record.mutable_families(0);
  family.set_evaluations(made.evaluations());
  family.set_failed_evaluations(made.failed_evaluations());
  family.set_truncated(made.truncated());
  family.set_interpolation_error(made.interpolation_error());
  family.set_fault(made.fault());
  if (made.sha256().empty() != !made.fault().empty()) {
    return InvalidField("cover.sha256", "is either there, or a fault");
  }
  if (made.sha256().empty()) return record;
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Descriptor> descriptor,
                           MakeDescriptor(IndexIdOf(wanted->shape_descriptor())));
  const absl::StatusOr<FamilyCover> cover = ReadCover(*blobs_, made.sha256(), *descriptor);
  if (!cover.ok()) {
    return InvalidField("cover.sha256",
                        absl::StrCat("is no cover that can be used: ", cover.status().message()));
  }
  CountPrimitives(*cover, &family);
  record.set_sha256(made.sha256());
  return record;
}

// What becomes of a task whose worker has no cover for it.
absl::Status CoverQueue::Settle(const std::string& key, std::int64_t attempt,
                                const absl::Status& error) {
  const bool is_gone = absl::IsNotFound(error);
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    if (absl::IsCancelled(error)) return transaction.ReleaseTask(kCoverQueue, key, attempt);
    if (is_gone) return transaction.CompleteTask(kCoverQueue, key, attempt, "").status();
    return transaction.FailTask(kCoverQueue, key, attempt, rpc::ToProto(error).SerializeAsString(),
                                IsPassingFailure(error), kAgainAfter);
  }));
  Tell(is_gone ? std::optional(key) : std::nullopt);
  return absl::OkStatus();
}

absl::Status CoverQueue::Report(const std::string& key, const v1::ReportCoverRequest& report,
                                absl::Duration lease) {
  const std::int64_t attempt = report.attempt();
  if (report.has_error()) {
    const absl::Status error = rpc::FromProto(report.error());
    if (error.ok()) return InvalidField("error", "must have a code other than OK");
    return Settle(key, attempt, error);
  }
  v1::CoverTask task;
  MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& read) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const store::Task stored, read.GetTask(kCoverQueue, key));
    MORTISE_ASSIGN_OR_RETURN(task, TaskOf(stored));
    return absl::OkStatus();
  }));
  const absl::StatusOr<v1::ShapeIndex> record = RecordOf(task, report.cover());
  if (!record.ok()) {
    // It would be no better if it were sent again: another attempt may do better.
    Settle(key, attempt, absl::AbortedError(record.status().message())).IgnoreError();
    return record.status();
  }
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    if (!report.last()) {
      MORTISE_RETURN_IF_ERROR(transaction.RenewLease(kCoverQueue, key, attempt, lease));
    } else {
      MORTISE_RETURN_IF_ERROR(transaction.CompleteTask(kCoverQueue, key, attempt, "").status());
    }
    MORTISE_RETURN_IF_ERROR(PutCover(transaction, IndexIdOf(record->shape_descriptor()), *record));
    for (const v1::WantedCover& wanted : task.covers()) {
      if (!report.last()) break;
      MORTISE_ASSIGN_OR_RETURN(const bool is_there,
                               IsThere(transaction, task.family(), wanted, true));
      if (!is_there) return InvalidField("last", "covers that were asked for are missing");
    }
    return absl::OkStatus();
  }));
  if (report.last()) Tell(key);
  return absl::OkStatus();
}

}  // namespace mortise::retrieval
