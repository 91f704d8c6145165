// Keeps the indexes that there are up to the catalog's templates.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/service/index_builds.h"

namespace grpc {
class Channel;
}

namespace mortise::retrieval {

// Follows the catalog's events about templates. When a template has come, changed or gone, each
// index that is kept up to it (ShapeIndex.every_template) says that it is not current, and an
// operation is started that brings all of these up to the templates. What was missed while the
// catalog or this service was away is noticed when they meet again. Indexes that were never built
// are left alone: building costs minutes of all cores. So is an index whose build somebody
// cancelled, until a template has come, changed or gone, or somebody has it built.
class IndexUpkeep {
 public:
  // All outlive it.
  IndexUpkeep(rpc::ServiceEnvironment& environment, std::shared_ptr<grpc::Channel> catalog,
              const TemplateSource& templates);
  ~IndexUpkeep();

 private:
  void Follow(const std::stop_token& stop);
  void Check(const std::stop_token& stop);
  absl::StatusOr<bool> BringUp();
  absl::Status StartBuild(store::Transaction& transaction, const v1::BuildIndexRequest& request,
                          const Revisions& present);
  void Notice();
  rpc::Origin Origin(absl::Duration timeout) const;

  rpc::ServiceEnvironment& environment_;
  const std::shared_ptr<grpc::Channel> catalog_;
  const TemplateSource& templates_;
  std::mutex mutex_;
  std::condition_variable_any noticed_;
  bool has_news_ = false;
  int starts_ = 0;  // of builds since all indexes were last current; the checker's
  std::jthread follower_;
  std::jthread checker_;
};

}  // namespace mortise::retrieval
