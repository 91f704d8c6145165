#include "hwbridge/cutting/work_order_runner.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::hwbridge {

WorkOrderRunner::WorkOrderRunner(const Options& options, std::vector<MachineSetup> machines,
                                 Journal& journal, const Clock& clock,
                                 std::function<void()> on_change)
    : options_(options), journal_(journal), on_change_(std::move(on_change)) {
  for (MachineSetup& setup : machines) {
    Station station{setup.worker.name, setup.worker.kind, std::move(setup.link), nullptr};
    station.worker = std::make_unique<MachineWorker>(setup.worker, *station.link, journal, clock);
    stations_.push_back(std::move(station));
  }
  for (Station& station : stations_) {
    threads_.emplace_back([this, &station](std::stop_token stop) { Scan(stop, station); });
  }
}

WorkOrderRunner::~WorkOrderRunner() = default;

void WorkOrderRunner::Scan(std::stop_token stop, Station& station) {
  MachineView seen;
  std::int64_t reports = 0;
  long wakes = 0;
  while (!stop.stop_requested()) {
    station.worker->Cycle();
    const MachineView view = station.worker->View();
    const std::int64_t next_report = journal_.NextReportNumber();
    if (view != seen || next_report != reports) {
      seen = view;
      reports = next_report;
      on_change_();
    }
    std::unique_lock lock(mutex_);
    changed_.notify_all();
    changed_.wait_for(lock, stop, std::chrono::duration<double>(options_.scan_period),
                      [&] { return wakes_ != wakes; });
    wakes = wakes_;
  }
}

absl::Status WorkOrderRunner::Check(const CutOrder& order) const {
  const auto station = std::find_if(stations_.begin(), stations_.end(), [&](const Station& other) {
    return other.name == order.key.machine;
  });
  if (station == stations_.end()) {
    return InvalidField("machine", absl::StrCat("'", order.key.machine, "' is not at this bridge"));
  }
  if (station->kind != order.job.kind) {
    return InvalidField("cut", absl::StrCat("is not one that '", order.key.machine, "' can make"));
  }
  return EncodeJob(order.job, 1).status();
}

absl::Status WorkOrderRunner::Accept(const CutOrder& order) {
  const absl::Status usable = Check(order);
  if (!usable.ok()) {
    MORTISE_RETURN_IF_ERROR(journal_.AddRejection(order.key, std::string(usable.message())));
    on_change_();
    return absl::OkStatus();
  }
  MORTISE_RETURN_IF_ERROR(journal_.AddCut(order).status());
  Wake();
  return absl::OkStatus();
}

void WorkOrderRunner::Wake() {
  const std::lock_guard lock(mutex_);
  ++wakes_;
  changed_.notify_all();
}

void WorkOrderRunner::Hold(std::string_view work_order, std::string_view because) {
  for (Station& station : stations_) station.worker->Hold(work_order, because);
}

absl::Status WorkOrderRunner::Resume(std::string_view work_order) {
  absl::Status first = absl::OkStatus();
  for (Station& station : stations_) first.Update(station.worker->Resume(work_order));
  Wake();
  return first;
}

absl::Status WorkOrderRunner::ClearAlarm(std::string_view machine) {
  for (Station& station : stations_) {
    if (station.name != machine) continue;
    MORTISE_RETURN_IF_ERROR(station.worker->ClearAlarm());
    Wake();
    return absl::OkStatus();
  }
  return InvalidField("machine",
                      absl::StrCat("'", std::string(machine), "' is not at this bridge"));
}

std::vector<MachineView> WorkOrderRunner::Machines() const {
  std::vector<MachineView> views;
  for (const Station& station : stations_) views.push_back(station.worker->View());
  return views;
}

bool WorkOrderRunner::WaitUntilOnline(double seconds) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] {
    return std::all_of(stations_.begin(), stations_.end(),
                       [](const Station& station) { return station.worker->View().online; });
  });
}

absl::Status WorkOrderRunner::AdoptNumbers() {
  absl::Status first = absl::OkStatus();
  for (Station& station : stations_) first.Update(station.worker->AdoptNumbers());
  return first;
}

}  // namespace mortise::hwbridge
