// What all figures of the evaluation share: families, labelled shapes, descriptors, covers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/index/primitive_index.h"
#include "tests/bench/services/retrieval/evaluation/evaluation_families.h"
#include "tests/bench/services/retrieval/evaluation/labelled_shapes.h"

namespace mortise::retrieval {

struct StudySettings {
  std::filesystem::path shapes;  // a folder of labelled shapes; without one random designs stand in
  std::filesystem::path out;
  std::uint64_t seed = 1;
  int threads = 1;
  int families = 0;      // at most so many of what ships, and of each category of meshes; 0 for all
  long evaluations = 0;  // at most so many for one cover; 0 for StudyEffort's
  bool points = false;   // covers of points alone: coarser for their cost, but soon made
  bool kernel = false;   // also families whose solids the kernel makes anew for each design, which
                         // take hundreds of times as long as all others
  bool quick = false;    // a handful of families and samples: whether all works, not what comes out
};

// How much is done: δ are in natural scales of the descriptor (DescriptorProperties).
struct StudyEffort {
  int rejections = 300;                         // that end a cover
  int most_primitives = 200;                    // of the cover of a family by a descriptor and δ
  long most_evaluations = 2'000;                // as well
  std::vector<double> deltas{0.5, 0.35, 0.25};  // of the families' covers; the last is the finest
  std::vector<double> accuracy_deltas{0.1, 0.17, 0.28, 0.45};   // 2 parameters (4-8)
  std::vector<double> other_accuracy_deltas{0.3};               // 3, 5, 7 parameters
  std::vector<double> cost_deltas{0.13, 0.2, 0.3, 0.45, 0.65};  // (4-9)
  long most_measured = 6'000;  // evaluations of one cover in Figures 4-8 and 4-9
  int accuracy_samples = 60;   // of errors; a third with more parameters than two
  int random_designs = 20;     // of each family (4-10)
};

class Study {
 public:
  // Loads what there is to search. `say` is told what is under way.
  static absl::StatusOr<std::unique_ptr<Study>> Create(StudySettings settings,
                                                       std::function<void(std::string_view)> say);

  const StudySettings& settings() const { return settings_; }
  const StudyEffort& effort() const { return effort_; }
  const std::vector<EvaluationFamily>& families() const { return families_; }
  const std::vector<LabelledShape>& shapes() const { return shapes_; }
  const std::vector<std::shared_ptr<const Descriptor>>& descriptors() const { return descriptors_; }
  void Say(std::string_view what) const { say_(what); }

  // Tells everything that a figure is made of, but for the code.
  const std::string& digest() const { return digest_; }

  // δ in distances of a descriptor.
  static double DeltaOf(const Descriptor& descriptor, double scales) {
    return scales * descriptor.properties().natural_scale;
  }

  // The vectors of all labelled shapes, in their order.
  absl::StatusOr<const std::vector<Eigen::VectorXd>*> Described(std::size_t descriptor);

  // The families' covers by one of the effort's δ, by their places in families(); no primitives
  // where a family cannot be covered.
  absl::StatusOr<const std::vector<FamilyCover>*> Covers(std::size_t descriptor, double delta);

  // The same to search in, and the families as points at their mean shapes.
  absl::StatusOr<const PrimitiveIndex*> Manifolds(std::size_t descriptor, double delta);
  absl::StatusOr<const PrimitiveIndex*> MeanShapes(std::size_t descriptor);

  // The `count` families nearest to a vector, over the quarter turns, nearest first.
  absl::StatusOr<std::vector<IndexMatch>> Search(
      const PrimitiveIndex& index, std::size_t descriptor, const Eigen::VectorXd& vector, int count,
      const std::function<bool(int family)>& allowed = nullptr) const;

 private:
  Study(StudySettings settings, std::function<void(std::string_view)> say);
  absl::Status LoadFamilies();
  absl::Status LoadShapes();
  absl::Status CoverAll(std::size_t descriptor);

  using DeltaKey = std::pair<std::size_t, double>;

  StudySettings settings_;
  StudyEffort effort_;
  std::function<void(std::string_view)> say_;
  std::vector<EvaluationFamily> families_;
  std::vector<LabelledShape> shapes_;
  std::vector<std::shared_ptr<const Descriptor>> descriptors_;
  std::string digest_;
  std::map<std::size_t, std::vector<Eigen::VectorXd>> described_;
  std::map<DeltaKey, std::vector<FamilyCover>> covers_;
  std::map<DeltaKey, PrimitiveIndex> manifolds_;
  std::map<std::size_t, PrimitiveIndex> mean_shapes_;
};

}  // namespace mortise::retrieval
