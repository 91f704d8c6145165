#include "tests/unit/services/interpolator/building/formula_blocks.h"

#include <cmath>
#include <utility>

#include "common/base/digest.h"
#include "common/fields/fields_file.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"

namespace mortise::interpolator {
namespace {

fields::Field FieldOf(const std::string& name, const std::string& unit,
                      const std::string& load_case, fields::FieldPlace place,
                      const std::function<double(const Eigen::Vector3d&)>& formula,
                      const Eigen::Matrix3Xd& places) {
  fields::Field field{name, unit, load_case, place, Eigen::MatrixXd(1, places.cols())};
  for (Eigen::Index n = 0; n < places.cols(); ++n) field.values(0, n) = formula(places.col(n));
  return field;
}

}  // namespace

fields::DesignFields MakeBlock(const FormulaBlock& block) {
  const Eigen::Vector3d& size = block.size;
  const BlockShape shape = block.has_hole
                               ? PlateShape(size.x(), size.y(), size.z(), size.minCoeff() / 3)
                               : BoxShape(size);
  fields::DesignFields design =
      BlockDesign(shape, {.along = block.cells, .across = block.cells, .high = 2});
  const Eigen::Vector3d low = design.nodes.rowwise().minCoeff();
  const Eigen::Matrix3Xd places = (design.nodes.colwise() - low).array().colwise() / size.array();
  Eigen::Matrix3Xd centres = Eigen::Matrix3Xd::Zero(3, design.tetrahedra.cols());
  for (Eigen::Index e = 0; e < centres.cols(); ++e) {
    for (const int node : design.tetrahedra.col(e)) centres.col(e) += places.col(node) / 4;
  }
  design.fields.clear();
  if (block.temperature) {
    design.fields.push_back(
        FieldOf("temperature", "K", "", fields::FieldPlace::kNodes, block.temperature, places));
  }
  if (block.stress) {
    design.fields.push_back(
        FieldOf("stress", "Pa", "load", fields::FieldPlace::kElements, block.stress, centres));
  }
  return design;
}

absl::StatusOr<std::string> FileShelf::Put(const std::string& bytes) {
  const std::lock_guard lock(mutex_);
  ++puts_;
  std::string digest = Sha256Hex(bytes);
  files_[digest] = bytes;
  return digest;
}

absl::StatusOr<std::string> FileShelf::Get(const std::string& digest) const {
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(digest);
  if (found == files_.end()) return absl::NotFoundError("no file " + digest);
  return found->second;
}

int FileShelf::puts() const {
  const std::lock_guard lock(mutex_);
  return puts_;
}

void FileShelf::Remove(const std::string& digest) {
  const std::lock_guard lock(mutex_);
  files_.erase(digest);
}

MapPlan BlockPlan(int evaluations, int metrics) {
  MapPlan plan;
  plan.names = {"x", "y"};
  plan.base = Eigen::Vector2d(0, 0);
  plan.parameters.resize(2);
  plan.parameters[0] = {.name = "x", .unit = "m", .index = 0, .minimum = 0, .maximum = 1};
  plan.parameters[1] = {.name = "y", .unit = "m", .index = 1, .minimum = 0, .maximum = 1};
  if (metrics > 0) plan.metrics = {{"sum", "m", 0}};
  plan.evaluations = evaluations;
  plan.structures.resize(0, 1);
  return plan;
}

FormulaBlock PlainBlock(const Eigen::VectorXd& design) {
  const double x = design[0], y = design[1];
  FormulaBlock block;
  block.size = {1 + x, 1 + y / 2, 0.25};
  block.temperature = [y](const Eigen::Vector3d& place) {
    return 300 + 10 * std::exp(-3 * y) * (1 + place.x());
  };
  block.stress = [x](const Eigen::Vector3d& place) { return 1e6 * std::sin(3 * x + place.y()); };
  return block;
}

BuildOptions BlockOptions(const MapPlan& plan, FileShelf& shelf, int lanes, int batch, int threads,
                          std::function<FormulaBlock(const Eigen::VectorXd&)> make) {
  BuildOptions options;
  options.lanes = lanes;
  options.batch_size = batch;
  options.evaluate = [&shelf, make, metrics = static_cast<Eigen::Index>(plan.metrics.size())](
                         const std::vector<Eigen::VectorXd>& designs)
      -> absl::StatusOr<std::vector<DesignAnswer>> {
    std::vector<DesignAnswer> answers;
    for (const Eigen::VectorXd& design : designs) {
      DesignAnswer answer;
      answer.values = Eigen::VectorXd::Constant(metrics, design.sum());
      answer.file = shelf.Put(fields::WriteFields(MakeBlock(make(design))).value()).value();
      answers.push_back(std::move(answer));
    }
    return answers;
  };
  ShapeOptions shapes;
  shapes.threads = threads;
  shapes.fields = {{"temperature", 0}, {"stress", 0}};
  shapes.put = [&shelf](const std::string& bytes) { return shelf.Put(bytes); };
  shapes.get = [&shelf](const std::string& digest) { return shelf.Get(digest); };
  options.shapes = std::move(shapes);
  return options;
}

}  // namespace mortise::interpolator
