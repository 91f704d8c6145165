// What may be asked of designs beside their metrics, shape and fields, and whether a worker's file
// is what was asked for.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::simulator {

// Fails with INVALID_ARGUMENT naming the field, "design_fields.fields[2]", unless the space offers
// all that is wanted.
absl::Status CheckWanted(const v1::DesignSpace& space, const v1::DesignFieldsRequest& wanted);

// Fails with INVALID_ARGUMENT naming the field, "evaluator.space.fields[0].unit", unless geometry
// and fields of a registered evaluator's design space are usable; `field` is the space's path.
absl::Status CheckOffered(const v1::DesignSpace& space, const std::string& field);

// What is in a worker's file.
struct ReportedFile {
  v1::DesignFields description;
  std::vector<v1::DesignSpace::FieldDescription> fields;  // one for each name and load case
};

// Reads the file of this digest. INVALID_ARGUMENT naming "result.design_fields.sha256" where it has
// not been uploaded, is too large or is no such file. Takes about as long as reading it does.
absl::StatusOr<ReportedFile> ReadReported(store::BlobFolder& blobs, const std::string& sha256);

// Has the result of a registered evaluator say what is in its file, which was read before if the
// result names one. INVALID_ARGUMENT naming "result.design_fields…" unless it is there just where
// the task asked for it, with the geometry, the regions, and the fields as the space describes
// them; also where reading it failed.
absl::Status CompleteDesignFields(const v1::Task& task, const v1::DesignSpace& space,
                                  const absl::StatusOr<ReportedFile>& file,
                                  v1::EvaluationResult& result);

}  // namespace mortise::simulator
