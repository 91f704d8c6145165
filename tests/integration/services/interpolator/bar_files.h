// The simulator's files of designs in the test's process: bars whose shape follows x and y.
#pragma once

#include <grpcpp/grpcpp.h>

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/digest.h"
#include "common/fields/fields_file.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/support/bar_design.h"

namespace mortise::interpolator {

// Thread safe.
class BarFiles : public v1::SimulatorService::Service {
 public:
  // The file of the design, without the fields that are not asked for.
  v1::DesignFields Put(const std::vector<double>& x, const v1::DesignFieldsRequest& wanted) {
    fields::DesignFields design = testing::BarDesign(x[0], x[1], CellsOf(x));
    // Names alone tell that there are so many.
    for (int i = 1; is_each_apart_ && i < CellsOf(x); ++i) {
      design.parts.push_back("part " + std::to_string(i));
    }
    if (IsOther(x)) design.parts.push_back("another");
    std::erase_if(design.fields, [&](const fields::Field& field) {
      return std::ranges::find(wanted.fields(), field.name) == wanted.fields().end();
    });
    if (wanted.geometry() != v1::TETRAHEDRA) {
      design.tetrahedra.resize(4, 0);
      design.tetrahedron_part.resize(0);
    }
    std::string bytes = fields::WriteFields(design).value();
    if (IsSpoilt(x)) bytes.resize(bytes.size() / 2);
    v1::DesignFields file;
    file.set_sha256(Sha256Hex(bytes));
    file.set_size(static_cast<std::int64_t>(bytes.size()));
    const std::lock_guard lock(mutex_);
    files_[file.sha256()] = bytes;
    return file;
  }

  grpc::Status DownloadBlob(grpc::ServerContext*, const v1::DownloadBlobRequest* request,
                            grpc::ServerWriter<v1::Chunk>* writer) override {
    const std::lock_guard lock(mutex_);
    ++downloads_;
    const auto found = files_.find(request->sha256());
    if (found == files_.end()) return {grpc::StatusCode::NOT_FOUND, "it is gone"};
    v1::Chunk chunk;
    chunk.set_total_size(static_cast<std::int64_t>(found->second.size()));
    chunk.set_data(found->second);
    writer->Write(chunk);
    if (lose_each_) files_.erase(found);
    return grpc::Status::OK;
  }

  // Forgets all files, as the simulator does after a day.
  void Lose() {
    const std::lock_guard lock(mutex_);
    files_.clear();
  }
  // From now on each file is gone once it was fetched.
  void LoseEach() {
    const std::lock_guard lock(mutex_);
    lose_each_ = true;
  }
  // How fine bars are from now on.
  void SetCells(int cells) {
    const std::lock_guard lock(mutex_);
    cells_ = cells;
  }
  // From now on no two designs have the same parts.
  void SetEachApart() {
    const std::lock_guard lock(mutex_);
    is_each_apart_ = true;
  }
  // From now on designs beyond this x are finer and have a part more, so that they are in no mesh
  // of the others.
  void SetOtherBeyond(double x) {
    const std::lock_guard lock(mutex_);
    other_beyond_ = x;
  }
  // From now on files of designs with this x are cut short.
  void Spoil(double x) {
    const std::lock_guard lock(mutex_);
    spoilt_ = x;
  }
  int downloads() {
    const std::lock_guard lock(mutex_);
    return downloads_;
  }

 private:
  int CellsOf(const std::vector<double>& x) {
    const std::lock_guard lock(mutex_);
    if (other_beyond_ && x[0] > *other_beyond_) return cells_ + 1;
    if (!is_each_apart_) return cells_;
    return numbers_.try_emplace(x, 2 + static_cast<int>(numbers_.size())).first->second;
  }

  bool IsOther(const std::vector<double>& x) {
    const std::lock_guard lock(mutex_);
    return other_beyond_ && x[0] > *other_beyond_;
  }

  bool IsSpoilt(const std::vector<double>& x) {
    const std::lock_guard lock(mutex_);
    return spoilt_ == x[0];
  }

  std::mutex mutex_;
  std::map<std::vector<double>, int> numbers_;  // of designs that are each apart
  bool is_each_apart_ = false;
  std::optional<double> spoilt_;              // x
  std::optional<double> other_beyond_;        // x
  std::map<std::string, std::string> files_;  // by digest
  bool lose_each_ = false;
  int cells_ = 3;
  int downloads_ = 0;
};

}  // namespace mortise::interpolator
