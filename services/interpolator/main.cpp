// mortise-interpolator: maps of design spaces as a service.
#include <CLI/CLI.hpp>

#include "common/host/run_service.h"
#include "services/interpolator/records/disk_quota.h"
#include "services/interpolator/service/interpolator_service.h"

int main(int argc, char** argv) {
  double disk_quota = mortise::interpolator::kDefaultDiskQuota / 1e9;
  mortise::rpc::ServiceDescription description;
  description.name = "interpolator";
  description.title = "Samples design spaces ahead of time and interpolates what is known of them";
  description.add_flags = [&disk_quota](CLI::App& app) {
    app.add_option("--map-disk-quota", disk_quota,
                   "GB of disk that all maps together may take; builds that would take more end")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->envname("MORTISE_MAP_DISK_QUOTA");
  };
  return mortise::rpc::RunService(
      argc, argv, description, [&disk_quota](mortise::rpc::ServiceEnvironment& environment) {
        return mortise::interpolator::MakeServices(environment, 1e9 * disk_quota);
      });
}
