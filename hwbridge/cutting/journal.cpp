#include "hwbridge/cutting/journal.h"

#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "hwbridge/registers/whole_number.h"

namespace mortise::hwbridge {
namespace {

using Json = nlohmann::ordered_json;

Json KeyToJson(const char* type, const CutKey& key) {
  return {{"type", type},
          {"work_order", key.work_order},
          {"machine", key.machine},
          {"sequence", key.sequence}};
}

CutKey KeyFromJson(const Json& json) {
  return {json.at("work_order").get<std::string>(), json.at("machine").get<std::string>(),
          WholeNumber<std::int64_t>(json.at("sequence"))};
}

Json CutToJson(const CutOrder& order) {
  Json json = KeyToJson("cut", order.key);
  json["kind"] = static_cast<int>(order.job.kind);
  json["part"] = order.job.part;
  json["stock"] = order.job.stock;
  json["position"] = order.job.position;
  json["length"] = order.job.length;
  json["outline"] = Json::array();
  for (const OutlinePoint& point : order.job.outline) json["outline"].push_back({point.x, point.y});
  return json;
}

CutOrder CutFromJson(const Json& json) {
  CutOrder order;
  order.key = KeyFromJson(json);
  order.job.kind = static_cast<MachineKind>(WholeNumber<int>(json.at("kind")));
  order.job.part = json.at("part").get<std::string>();
  order.job.stock = json.at("stock").get<std::string>();
  order.job.position = json.at("position").get<double>();
  order.job.length = json.at("length").get<double>();
  for (const Json& point : json.at("outline")) {
    order.job.outline.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
  }
  return order;
}

Json IntentToJson(const Intent& intent) {
  Json json = KeyToJson("intent", intent.key);
  json["number"] = intent.number;
  json["identity"] = intent.identity;
  json["boot_epoch"] = intent.boot_epoch;
  return json;
}

Intent IntentFromJson(const Json& json) {
  return {KeyFromJson(json),
          WholeNumber<std::uint32_t>(json.at("number")),
          WholeNumber<std::uint32_t>(json.at("identity")),
          WholeNumber<std::uint32_t>(json.at("boot_epoch")),
          JobResult::kNone,
          0.0,
          false,
          ""};
}

Json ReportToJson(const CutReport& report) {
  Json json = KeyToJson("report", report.key);
  json["number"] = report.number;
  json["outcome"] = static_cast<int>(report.outcome);
  json["message"] = report.message;
  json["seconds"] = report.seconds;
  return json;
}

CutReport ReportFromJson(const Json& json) {
  return {WholeNumber<std::int64_t>(json.at("number")), KeyFromJson(json),
          static_cast<CutOutcome>(WholeNumber<int>(json.at("outcome"))),
          json.at("message").get<std::string>(), json.at("seconds").get<double>()};
}

// An older bridge reads these as the adoption of number 0, which changes nothing, so that it can
// still be put back in the place of a newer one.
Json AlarmToJson(std::string_view machine, std::string_view because) {
  return {{"type", "adopted"}, {"machine", machine}, {"number", 0}, {"alarm", because}};
}

Json ClearedAlarmToJson(std::string_view machine, const RememberedEcho& seen) {
  Json json = AlarmToJson(machine, "");
  json["identity"] = seen.identity;
  json["boot_epoch"] = seen.boot_epoch;
  json["accepted"] = seen.accepted;
  json["done"] = seen.done;
  json["result"] = static_cast<std::uint16_t>(seen.result);
  return json;
}

RememberedEcho EchoFromJson(const Json& json) {
  return {WholeNumber<std::uint32_t>(json.at("identity")),
          WholeNumber<std::uint32_t>(json.at("boot_epoch")),
          WholeNumber<std::uint32_t>(json.at("accepted")),
          WholeNumber<std::uint32_t>(json.at("done")),
          static_cast<JobResult>(WholeNumber<std::uint16_t>(json.at("result")))};
}

std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

Journal::Journal(std::unique_ptr<DurableLog> log) : log_(std::move(log)) {}

absl::StatusOr<std::unique_ptr<Journal>> Journal::Open(const std::filesystem::path& path,
                                                       const DurableLog::Options& options) {
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<DurableLog> log, DurableLog::Open(path, options));
  const std::vector<std::string> lines = log->TakeLines();
  std::unique_ptr<Journal> journal(new Journal(std::move(log)));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const absl::Status status = journal->Replay(lines[i]);
    if (status.ok()) continue;
    return absl::DataLossError(absl::StrCat(path.string(), ":", i + 1, ": ", status.message()));
  }
  return journal;
}

absl::Status Journal::Append(const std::string& line) {
  MORTISE_RETURN_IF_ERROR(log_->Append(line));
  return Replay(line);
}

// Memory is only ever changed by replaying a line, so that a restart cannot see anything else.
absl::Status Journal::Replay(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    const std::string type = json.at("type").get<std::string>();
    if (type == "cut") return Apply(CutFromJson(json));
    if (type == "intent") return Apply(IntentFromJson(json));
    if (type == "report") return Apply(ReportFromJson(json));
    if (type == "acknowledged") {
      return ApplyAcknowledgement(WholeNumber<std::int64_t>(json.at("number")));
    }
    if (type == "adopted") {
      MachineBook& book = machines_[json.at("machine").get<std::string>()];
      book.highest = std::max(book.highest, WholeNumber<std::uint32_t>(json.at("number")));
      if (!json.contains("alarm")) return absl::OkStatus();
      book.alarm = json.at("alarm").get<std::string>();
      if (book.alarm.empty()) book.echo = EchoFromJson(json);
      return absl::OkStatus();
    }
    if (type == "accepted") {
      return ApplyAcceptance(json.at("machine").get<std::string>(),
                             WholeNumber<std::uint32_t>(json.at("number")));
    }
    if (type != "result") return absl::DataLossError(absl::StrCat("unknown record '", type, "'"));
    return ApplyResult(json.at("machine").get<std::string>(),
                       WholeNumber<std::uint32_t>(json.at("number")),
                       static_cast<JobResult>(WholeNumber<std::uint16_t>(json.at("result"))),
                       json.at("seconds").get<double>(), json.value("because", ""));
  } catch (const std::exception& error) {
    return absl::DataLossError(error.what());
  }
}

absl::Status Journal::Apply(CutOrder order) {
  const CutKey key = order.key;
  if (!cuts_.try_emplace(key, Entry{std::move(order), {}, false}).second) {
    return absl::DataLossError("the cut was given before");
  }
  machines_[key.machine].arrivals.push_back(key);
  return absl::OkStatus();
}

absl::Status Journal::Apply(const Intent& intent) {
  MachineBook& book = machines_[intent.key.machine];
  if (intent.number <= book.highest) return absl::DataLossError("the number does not grow");
  const auto cut = cuts_.find(intent.key);
  if (cut == cuts_.end()) return absl::DataLossError("the intent has no cut");
  book.highest = intent.number;
  book.numbers[intent.number] = intent.key;
  cut->second.intents.push_back(intent);
  // What another memory knew tells nothing of what this one knows.
  if (!book.echo || book.echo->identity != intent.identity) {
    book.echo = RememberedEcho{.identity = intent.identity};
  }
  Remember(book, intent);
  return absl::OkStatus();
}

void Journal::Remember(MachineBook& book, const Intent& intent) {
  if (!book.echo || book.echo->identity != intent.identity) return;
  RememberedEcho& echo = *book.echo;
  echo.boot_epoch = std::max(echo.boot_epoch, intent.boot_epoch);
  const bool known = intent.result != JobResult::kNone && intent.result != JobResult::kUnknown;
  if (known || intent.accepted) echo.accepted = std::max(echo.accepted, intent.number);
  if (!known || intent.number < echo.done) return;
  echo.done = intent.number;
  echo.result = intent.result;
}

absl::Status Journal::ApplyAcceptance(const std::string& machine, std::uint32_t number) {
  Intent* intent = LatestIntent(machine, number);
  if (intent == nullptr) return absl::DataLossError("the acceptance has no open intent");
  intent->accepted = true;
  Remember(machines_[machine], *intent);
  return absl::OkStatus();
}

absl::Status Journal::ApplyResult(const std::string& machine, std::uint32_t number,
                                  JobResult result, double seconds, std::string because) {
  Intent* intent = LatestIntent(machine, number);
  if (intent == nullptr) return absl::DataLossError("the result has no open intent");
  intent->result = result;
  intent->seconds = seconds;
  intent->because = std::move(because);
  Remember(machines_[machine], *intent);
  return absl::OkStatus();
}

absl::Status Journal::Apply(const CutReport& report) {
  if (report.number != next_report_) return absl::DataLossError("a report is missing");
  next_report_ = report.number + 1;
  // A report without a cut is that of a cut which was never taken over.
  cuts_.try_emplace(report.key, Entry{CutOrder{report.key, Job{}}, {}, false})
      .first->second.reported = true;
  unacknowledged_[report.number] = report;
  MachineBook& book = machines_[report.key.machine];
  while (book.first_open < book.arrivals.size() &&
         cuts_.at(book.arrivals[book.first_open]).reported) {
    ++book.first_open;
  }
  return absl::OkStatus();
}

absl::Status Journal::ApplyAcknowledgement(std::int64_t number) {
  acknowledged_ = std::max(acknowledged_, number);
  unacknowledged_.erase(unacknowledged_.begin(), unacknowledged_.upper_bound(acknowledged_));
  return absl::OkStatus();
}

Intent* Journal::LatestIntent(std::string_view machine, std::uint32_t number) {
  const auto book = machines_.find(machine);
  if (book == machines_.end()) return nullptr;
  const auto key = book->second.numbers.find(number);
  if (key == book->second.numbers.end()) return nullptr;
  Intent& intent = cuts_.at(key->second).intents.back();
  return intent.number == number ? &intent : nullptr;
}

absl::StatusOr<bool> Journal::AddCut(const CutOrder& order) {
  const std::lock_guard lock(mutex_);
  if (cuts_.contains(order.key)) return false;
  // JSON has no word for NaN: what cannot be encoded for the machine must not reach the file.
  MORTISE_RETURN_IF_ERROR(EncodeJob(order.job, 1).status());
  MORTISE_RETURN_IF_ERROR(Append(Dump(CutToJson(order))));
  return true;
}

std::vector<CutOrder> Journal::OpenCuts(std::string_view machine) const {
  const std::lock_guard lock(mutex_);
  std::vector<CutOrder> open;
  const auto book = machines_.find(machine);
  if (book == machines_.end()) return open;
  for (std::size_t i = book->second.first_open; i < book->second.arrivals.size(); ++i) {
    const Entry& entry = cuts_.at(book->second.arrivals[i]);
    if (!entry.reported) open.push_back(entry.order);
  }
  return open;
}

absl::Status Journal::AddIntent(const Intent& intent) {
  const std::lock_guard lock(mutex_);
  const auto book = machines_.find(intent.key.machine);
  if (!cuts_.contains(intent.key)) return ResourceNotFound(intent.key.work_order);
  if (book != machines_.end() && intent.number <= book->second.highest) {
    return PreconditionFailed("NUMBER_USED",
                              absl::StrCat("number ", intent.number, " was given before"));
  }
  return Append(Dump(IntentToJson(intent)));
}

absl::Status Journal::AddAcceptance(std::string_view machine, std::uint32_t number) {
  const std::lock_guard lock(mutex_);
  if (LatestIntent(machine, number) == nullptr) {
    return ResourceNotFound(absl::StrCat(std::string(machine), " number ", number));
  }
  return Append(Dump({{"type", "accepted"}, {"machine", machine}, {"number", number}}));
}

absl::Status Journal::AddResult(std::string_view machine, std::uint32_t number, JobResult result,
                                double seconds, std::string_view because) {
  const std::lock_guard lock(mutex_);
  if (LatestIntent(machine, number) == nullptr) {
    return ResourceNotFound(absl::StrCat(std::string(machine), " number ", number));
  }
  Json json = {{"type", "result"},
               {"machine", machine},
               {"number", number},
               {"result", static_cast<std::uint16_t>(result)},
               {"seconds", seconds}};
  if (!because.empty()) json["because"] = because;
  return Append(Dump(json));
}

std::vector<Intent> Journal::Intents(const CutKey& key) const {
  const std::lock_guard lock(mutex_);
  const auto cut = cuts_.find(key);
  return cut == cuts_.end() ? std::vector<Intent>{} : cut->second.intents;
}

std::uint32_t Journal::HighestNumber(std::string_view machine) const {
  const std::lock_guard lock(mutex_);
  const auto book = machines_.find(machine);
  return book == machines_.end() ? 0 : book->second.highest;
}

absl::Status Journal::AdoptNumber(std::string_view machine, std::uint32_t number) {
  const std::lock_guard lock(mutex_);
  return Append(Dump({{"type", "adopted"}, {"machine", machine}, {"number", number}}));
}

absl::Status Journal::AddAlarm(std::string_view machine, std::string_view because) {
  const std::lock_guard lock(mutex_);
  return Append(Dump(AlarmToJson(machine, because)));
}

absl::Status Journal::ClearAlarm(std::string_view machine, const RememberedEcho& seen) {
  const std::lock_guard lock(mutex_);
  return Append(Dump(ClearedAlarmToJson(machine, seen)));
}

std::string Journal::Alarm(std::string_view machine) const {
  const std::lock_guard lock(mutex_);
  const auto book = machines_.find(machine);
  return book == machines_.end() ? "" : book->second.alarm;
}

std::optional<RememberedEcho> Journal::LastEcho(std::string_view machine) const {
  const std::lock_guard lock(mutex_);
  const auto book = machines_.find(machine);
  return book == machines_.end() ? std::nullopt : book->second.echo;
}

absl::StatusOr<CutReport> Journal::AddReport(const CutKey& key, CutOutcome outcome,
                                             std::string_view message, double seconds) {
  const std::lock_guard lock(mutex_);
  const auto cut = cuts_.find(key);
  if (cut == cuts_.end()) return ResourceNotFound(key.work_order);
  if (cut->second.reported) {
    return PreconditionFailed("CUT_REPORTED", absl::StrCat("cut ", key.sequence, " of ",
                                                           key.work_order, " has a report"));
  }
  const CutReport report{next_report_, key, outcome, std::string(message), seconds};
  MORTISE_RETURN_IF_ERROR(Append(Dump(ReportToJson(report))));
  return report;
}

absl::Status Journal::AddRejection(const CutKey& key, std::string_view message) {
  const std::lock_guard lock(mutex_);
  if (cuts_.contains(key)) return absl::OkStatus();
  return Append(
      Dump(ReportToJson({next_report_, key, CutOutcome::kRejected, std::string(message), 0.0})));
}

std::vector<CutReport> Journal::UnacknowledgedReports() const {
  const std::lock_guard lock(mutex_);
  std::vector<CutReport> reports;
  for (const auto& [number, report] : unacknowledged_) reports.push_back(report);
  return reports;
}

absl::Status Journal::AddAcknowledgement(std::int64_t number) {
  const std::lock_guard lock(mutex_);
  if (number <= acknowledged_) return absl::OkStatus();
  if (number >= next_report_) {
    return InvalidField("report_number", absl::StrCat("report ", number, " was never made"));
  }
  return Append(Dump({{"type", "acknowledged"}, {"number", number}}));
}

std::int64_t Journal::NextReportNumber() const {
  const std::lock_guard lock(mutex_);
  return next_report_;
}

}  // namespace mortise::hwbridge
