// Asks the evaluator of a map.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/evaluation/evaluator_client.h"
#include "common/host/run_service.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/building/map_building.h"

namespace mortise::interpolator {

// The evaluator as operations ask it: as the service itself. Thread safe.
class MapEvaluator {
 public:
  // Describes the subject first; an evaluator that is away is waited for, as long as `stop` is not
  // asked. The environment outlives it. FAILED_PRECONDITION, PEER_UNKNOWN, and what
  // DescribeDesignSpace fails with.
  static absl::StatusOr<std::unique_ptr<MapEvaluator>> Create(
      rpc::ServiceEnvironment& environment, const v1::MapSpecification& specification,
      const std::stop_token& stop);

  // What the evaluator says of the subject.
  const v1::DesignSpace& described() const { return *described_; }

  // Returns an answer for each design, in the same order. As EvaluatorClient::Evaluate.
  absl::StatusOr<std::vector<DesignAnswer>> Evaluate(const std::vector<Eigen::VectorXd>& designs);

  // Returns the bytes of a file that an answer named, of maps with shapes. Where it is gone by now,
  // its design is evaluated again, and the file that it has then is as good. NOT_FOUND where no
  // answer has named it; what the design fails with now; DATA_LOSS and RESOURCE_EXHAUSTED as
  // FetchDesignFile; else as Evaluate.
  absl::StatusOr<std::string> Fetch(const std::string& file);

  // Which design (D) a file is of; nothing where no answer has named it, here or by Remember: in
  // an earlier run.
  std::optional<Eigen::VectorXd> DesignOf(const std::string& file) const;
  void Remember(const std::string& file, const Eigen::VectorXd& design);

  void Interrupt();

 private:
  MapEvaluator(rpc::ServiceEnvironment& environment, std::shared_ptr<grpc::Channel> channel,
               const v1::MapSpecification& specification,
               std::unique_ptr<v1::DesignSpace> described);

  std::string PresentOf(const std::string& file) const;

  const rpc::ServiceEnvironment& environment_;
  const std::string trace_id_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::DesignSpace> described_;
  const Eigen::Index metrics_;  // of the map; there may be one more in the question
  evaluation::EvaluatorClient client_;
  std::stop_source interruption_;
  mutable std::mutex mutex_;
  // Guarded by mutex_, by digest:
  std::map<std::string, Eigen::VectorXd> designs_;  // of files
  std::map<std::string, std::string> renewed_;      // files in the place of those that are gone
};

}  // namespace mortise::interpolator
