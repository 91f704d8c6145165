#include "hwbridge/virtual_cell/machine_memory.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "hwbridge/registers/whole_number.h"

namespace mortise::hwbridge {
namespace {

using Json = nlohmann::ordered_json;

Json JobToJson(const Job& job) {
  Json outline = Json::array();
  for (const OutlinePoint& point : job.outline) outline.push_back({point.x, point.y});
  return {{"kind", static_cast<int>(job.kind)}, {"part", job.part},     {"stock", job.stock},
          {"position", job.position},           {"length", job.length}, {"outline", outline}};
}

Job JobFromJson(const Json& json) {
  Job job;
  job.kind = static_cast<MachineKind>(WholeNumber<int>(json.at("kind")));
  job.part = json.at("part").get<std::string>();
  job.stock = json.at("stock").get<std::string>();
  job.position = json.at("position").get<double>();
  job.length = json.at("length").get<double>();
  for (const Json& point : json.at("outline")) {
    job.outline.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
  }
  return job;
}

Json CutToJson(const Cut& cut) {
  return {{"machine", cut.machine},
          {"sequence_number", cut.sequence_number},
          {"part", cut.part},
          {"stock", cut.stock},
          {"length", cut.length}};
}

std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// One write call, so that a killed process leaves a whole line or none.
absl::Status AppendLine(const std::filesystem::path& path, const std::string& line) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor < 0) return StorageFailed(path.string(), std::strerror(errno));
  const ssize_t written = ::write(descriptor, line.data(), line.size());
  const bool flushed = written == static_cast<ssize_t>(line.size()) && ::fsync(descriptor) == 0;
  const int error = errno;
  ::close(descriptor);
  return flushed ? absl::OkStatus() : StorageFailed(path.string(), std::strerror(error));
}

}  // namespace

FileMachineMemory::FileMachineMemory(std::string machine, std::filesystem::path state,
                                     std::filesystem::path cut_record)
    : machine_(std::move(machine)), state_(std::move(state)), cut_record_(std::move(cut_record)) {}

absl::StatusOr<MachineRecord> FileMachineMemory::Load() {
  MachineRecord record;
  absl::StatusOr<std::string> bytes = ReadFile(state_);
  if (absl::IsNotFound(bytes.status())) {
    std::random_device random;
    record.identity = random();
    return record;
  }
  MORTISE_RETURN_IF_ERROR(bytes.status());
  try {
    const Json json = Json::parse(*bytes);
    record.identity = WholeNumber<std::uint32_t>(json.at("identity"));
    record.boot_epoch = WholeNumber<std::uint32_t>(json.at("boot_epoch"));
    record.accepted = WholeNumber<std::uint32_t>(json.at("accepted"));
    record.done = WholeNumber<std::uint32_t>(json.at("done"));
    record.result = static_cast<JobResult>(WholeNumber<std::uint16_t>(json.at("result")));
    record.seconds = json.at("seconds").get<double>();
    record.tool_in_material = json.at("tool_in_material").get<bool>();
    if (json.contains("open_job")) record.open_job = JobFromJson(json.at("open_job"));
  } catch (const std::exception& error) {
    return absl::DataLossError(absl::StrCat(state_.string(), ": ", error.what()));
  }
  return record;
}

absl::Status FileMachineMemory::Store(const MachineRecord& record) {
  Json json = {{"identity", record.identity},
               {"boot_epoch", record.boot_epoch},
               {"accepted", record.accepted},
               {"done", record.done},
               {"result", static_cast<std::uint16_t>(record.result)},
               {"seconds", record.seconds},
               {"tool_in_material", record.tool_in_material}};
  if (record.open_job) json["open_job"] = JobToJson(*record.open_job);
  return WriteFile(state_, Dump(json) + "\n");
}

absl::Status FileMachineMemory::MakeCut(const Cut& cut) {
  return AppendLine(cut_record_, Dump(CutToJson(cut)) + "\n");
}

absl::StatusOr<Cut> FileMachineMemory::LastCut() {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Cut> cuts, ReadCutRecord(cut_record_));
  Cut last;
  for (const Cut& cut : cuts) {
    if (cut.machine == machine_) last = cut;
  }
  return last;
}

absl::StatusOr<std::uint32_t> FileMachineMemory::CutCount() {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Cut> cuts, ReadCutRecord(cut_record_));
  std::uint32_t count = 0;
  for (const Cut& cut : cuts) count += cut.machine == machine_ ? 1 : 0;
  return count;
}

absl::StatusOr<std::vector<Cut>> ReadCutRecord(const std::filesystem::path& path) {
  std::vector<Cut> cuts;
  absl::StatusOr<std::string> bytes = ReadFile(path);
  if (absl::IsNotFound(bytes.status())) return cuts;
  MORTISE_RETURN_IF_ERROR(bytes.status());
  std::istringstream lines(*bytes);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    try {
      const Json json = Json::parse(line);
      cuts.push_back({json.at("machine").get<std::string>(),
                      WholeNumber<std::uint32_t>(json.at("sequence_number")),
                      json.at("part").get<std::string>(), json.at("stock").get<std::string>(),
                      json.at("length").get<double>()});
    } catch (const std::exception& error) {
      return absl::DataLossError(absl::StrCat(path.string(), ":", number, ": ", error.what()));
    }
  }
  return cuts;
}

}  // namespace mortise::hwbridge
