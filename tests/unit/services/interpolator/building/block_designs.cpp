#include "tests/unit/services/interpolator/building/block_designs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/digest.h"
#include "common/fields/fields_file.h"

namespace mortise::interpolator {
namespace {

// The six tetrahedra of a cell around its diagonal from corner 0 to corner 7, whose numbers have a
// bit for each direction.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                   {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

class BlockMaker {
 public:
  explicit BlockMaker(const BlockDesign& block)
      : block_(block), count_{block.cells, block.cells, 2} {}

  fields::DesignFields Make() {
    AddCells();
    AddTriangles();
    AddControlVariables();
    AddFields();
    return std::move(design_);
  }

 private:
  int NodeAt(const std::array<int, 3>& at) {
    const auto [entry, is_new] = nodes_.try_emplace(at, static_cast<int>(nodes_.size()));
    if (is_new) {
      Eigen::Vector3d place;
      for (int d = 0; d < 3; ++d) place[d] = static_cast<double>(at[d]) / count_[d];
      places_.push_back(place);
    }
    return entry->second;
  }

  void AddCells() {
    std::vector<std::array<int, 4>> tetrahedra;
    for (int x = 0; x < count_[0]; ++x) {
      for (int y = 0; y < count_[1]; ++y) {
        if (block_.has_hole && x == count_[0] / 2 && y == count_[1] / 2) continue;
        for (int z = 0; z < count_[2]; ++z) {
          for (const auto& corners : kTetrahedra) {
            std::array<int, 4> nodes{};
            for (int c = 0; c < 4; ++c) {
              const int bits = corners[c];
              nodes[c] = NodeAt({x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2 & 1)});
            }
            tetrahedra.push_back(nodes);
          }
        }
      }
    }
    design_.nodes.resize(3, static_cast<Eigen::Index>(places_.size()));
    for (std::size_t n = 0; n < places_.size(); ++n) {
      design_.nodes.col(static_cast<Eigen::Index>(n)) = places_[n].cwiseProduct(block_.size);
    }
    design_.tetrahedra.resize(4, static_cast<Eigen::Index>(tetrahedra.size()));
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
      design_.tetrahedra.col(static_cast<Eigen::Index>(e)) =
          Eigen::Vector4i::Map(tetrahedra[e].data());
    }
    design_.tetrahedron_part = Eigen::VectorXi::Zero(design_.tetrahedra.cols());
    design_.parts = {"block"};
  }

  // The faces that one tetrahedron has alone, seen from outside.
  void AddTriangles() {
    constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    std::map<std::array<int, 3>, std::pair<int, Eigen::Vector3i>> faces;
    for (const auto& tetrahedron : design_.tetrahedra.colwise()) {
      for (const auto& face : kFaces) {
        const Eigen::Vector3i nodes(tetrahedron[face[0]], tetrahedron[face[1]],
                                    tetrahedron[face[2]]);
        std::array<int, 3> key = {nodes[0], nodes[1], nodes[2]};
        std::sort(key.begin(), key.end());
        auto& [count, oriented] = faces[key];
        ++count;
        oriented = nodes;
      }
    }
    std::vector<int> top;
    int outside = 0;
    for (const auto& [key, face] : faces) outside += face.first == 1 ? 1 : 0;
    design_.triangles.resize(3, outside);
    int triangle = 0;
    for (const auto& [key, face] : faces) {
      if (face.first != 1) continue;
      design_.triangles.col(triangle) = face.second;
      const bool is_top = std::ranges::all_of(key, [&](int n) { return places_[n].z() == 1; });
      if (is_top) top.push_back(triangle);
      ++triangle;
    }
    design_.triangle_back = Eigen::VectorXi::Zero(outside);
    design_.triangle_front = Eigen::VectorXi::Constant(outside, -1);
    design_.regions = {{"top", top}};
  }

  void AddControlVariables() {
    for (int corner = 0; corner < 8; ++corner) {
      std::array<int, 3> at{};
      for (int d = 0; d < 3; ++d) at[d] = (corner >> d & 1) * count_[d];
      const int node = NodeAt(at);
      design_.control_points.push_back(
          {"corner " + std::to_string(corner), design_.nodes.col(node), node});
      for (int d = 0; d < 3; ++d) {
        if ((corner >> d & 1) != 0) continue;
        fields::Path path{"edge " + std::to_string(corner) + " " + std::to_string(d), {}};
        for (std::array<int, 3> along = at; along[d] <= count_[d]; ++along[d]) {
          path.nodes.push_back(NodeAt(along));
        }
        design_.paths.push_back(std::move(path));
      }
    }
  }

  void AddFields() {
    if (block_.temperature) {
      fields::Field field{"temperature", "K", "", fields::FieldPlace::kNodes, {}};
      field.values.resize(1, design_.nodes.cols());
      for (Eigen::Index n = 0; n < field.values.cols(); ++n) {
        field.values(0, n) = block_.temperature(places_[static_cast<std::size_t>(n)]);
      }
      design_.fields.push_back(std::move(field));
    }
    if (!block_.stress) return;
    fields::Field field{"stress", "Pa", "load", fields::FieldPlace::kElements, {}};
    field.values.resize(1, design_.tetrahedra.cols());
    for (Eigen::Index e = 0; e < field.values.cols(); ++e) {
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const int node : design_.tetrahedra.col(e)) {
        centre += places_[static_cast<std::size_t>(node)] / 4;
      }
      field.values(0, e) = block_.stress(centre);
    }
    design_.fields.push_back(std::move(field));
  }

  const BlockDesign& block_;
  const std::array<int, 3> count_;
  std::map<std::array<int, 3>, int> nodes_;
  std::vector<Eigen::Vector3d> places_;
  fields::DesignFields design_;
};

}  // namespace

fields::DesignFields MakeBlock(const BlockDesign& block) { return BlockMaker(block).Make(); }

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

BlockDesign PlainBlock(const Eigen::VectorXd& design) {
  const double x = design[0], y = design[1];
  BlockDesign block;
  block.size = {1 + x, 1 + y / 2, 0.25};
  block.temperature = [y](const Eigen::Vector3d& place) {
    return 300 + 10 * std::exp(-3 * y) * (1 + place.x());
  };
  block.stress = [x](const Eigen::Vector3d& place) { return 1e6 * std::sin(3 * x + place.y()); };
  return block;
}

BuildOptions BlockOptions(const MapPlan& plan, FileShelf& shelf, int lanes, int batch, int threads,
                          std::function<BlockDesign(const Eigen::VectorXd&)> make) {
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
