#include "cli/launcher/state_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

absl::StatusOr<StateFolderLock> StateFolderLock::Take(const std::filesystem::path& folder) {
  // Writing a file first gives a full disk or an unwritable folder its own clear error.
  MORTISE_RETURN_IF_ERROR(WriteFile(folder / "README.txt",
                                    "The state of a Mortise house: stores, blobs, keys and logs.\n"
                                    "Stop it with `mortise down` before moving this folder.\n"));
  const std::filesystem::path path = folder / "lock";
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    return absl::PermissionDeniedError(absl::StrCat("cannot open ", path.string()));
  }
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    ::close(descriptor);
    return PreconditionFailed("STATE_FOLDER_IN_USE",
                              absl::StrCat("another launcher runs on ", folder.string(),
                                           "; stop it with `mortise down --state ", folder.string(),
                                           "` or choose another folder"),
                              "--state");
  }
  return StateFolderLock(descriptor);
}

StateFolderLock::StateFolderLock(StateFolderLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

StateFolderLock::~StateFolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

absl::StatusOr<RunningHouse> ReadRunningHouse(const std::filesystem::path& folder) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(folder / "house.json"));
  const Json document = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!document.is_object()) {
    return absl::DataLossError(absl::StrCat((folder / "house.json").string(), " is not JSON"));
  }
  RunningHouse house;
  house.launcher = document.value("launcher", 0);
  house.gateway_grpc = document.value("gateway_grpc", "");
  house.gateway_http = document.value("gateway_http", "");
  house.plain_text = document.value("plain_text", false);
  house.authority = document.value("authority", "");
  for (const Json& entry : document.value("processes", Json::array())) {
    house.processes.push_back({entry.value("name", ""), entry.value("pid", 0),
                               entry.value("address", ""), entry.value("restarts", 0),
                               entry.value("serving", false)});
  }
  return house;
}

absl::Status WriteRunningHouse(const std::filesystem::path& folder, const RunningHouse& house) {
  Json document = {{"launcher", house.launcher},         {"gateway_grpc", house.gateway_grpc},
                   {"gateway_http", house.gateway_http}, {"plain_text", house.plain_text},
                   {"authority", house.authority},       {"processes", Json::array()}};
  for (const RunningProcess& process : house.processes) {
    document["processes"].push_back({{"name", process.name},
                                     {"pid", process.pid},
                                     {"address", process.address},
                                     {"restarts", process.restarts},
                                     {"serving", process.serving}});
  }
  return WriteFile(folder / "house.json", document.dump(2) + "\n");
}

}  // namespace mortise::cli
