#include "tests/bench/services/retrieval/evaluation/study.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "tests/bench/services/retrieval/evaluation/family_covers.h"

namespace mortise::retrieval {
namespace {

// Raised when what the figures are made of changes and nothing else tells it.
constexpr int kFiguresVersion = 1;

const std::vector<std::string> kQuickFamilies{"bookshelf", "loaded-bookshelf", "step-stool",
                                              "table"};
constexpr int kStandIns = 3;  // random designs of each family in place of labelled shapes

StudyEffort QuickEffort() {
  StudyEffort effort;
  effort.rejections = 20;
  effort.most_primitives = 20;
  effort.most_evaluations = 400;
  effort.deltas = {0.7, 0.5};
  effort.accuracy_deltas = {0.3, 0.5};
  effort.other_accuracy_deltas = {};
  effort.cost_deltas = {0.5, 0.8};
  effort.most_measured = 1'000;
  effort.accuracy_samples = 10;
  effort.random_designs = 3;
  return effort;
}

}  // namespace

Study::Study(StudySettings settings, std::function<void(std::string_view)> say)
    : settings_(std::move(settings)),
      effort_(settings_.quick ? QuickEffort() : StudyEffort{}),
      say_(std::move(say)) {
  if (settings_.evaluations > 0) effort_.most_evaluations = settings_.evaluations;
}

absl::StatusOr<std::unique_ptr<Study>> Study::Create(StudySettings settings,
                                                     std::function<void(std::string_view)> say) {
  std::unique_ptr<Study> study(new Study(std::move(settings), std::move(say)));
  for (const std::string& name : DescriptorNames()) {
    MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const Descriptor> descriptor, MakeDescriptor(name));
    study->descriptors_.push_back(std::move(descriptor));
  }
  MORTISE_RETURN_IF_ERROR(study->LoadFamilies());
  MORTISE_RETURN_IF_ERROR(study->LoadShapes());
  std::string content = absl::StrFormat("%d %d %d %d %d", kFiguresVersion, study->settings_.seed,
                                        study->settings_.quick, study->settings_.points,
                                        study->effort_.most_evaluations);
  for (const EvaluationFamily& family : study->families_) {
    absl::StrAppend(&content, " ", family.name, family.design_template->head().digest);
  }
  for (const LabelledShape& shape : study->shapes_) absl::StrAppend(&content, " ", shape.name);
  for (const auto& descriptor : study->descriptors_) {
    absl::StrAppend(&content, " ", descriptor->properties().dimension);
  }
  study->digest_ = Sha256Hex(content);
  return study;
}

absl::Status Study::LoadFamilies() {
  say_("loading families");
  MORTISE_ASSIGN_OR_RETURN(
      families_, ShippedFamilies(settings_.quick ? kQuickFamilies : std::vector<std::string>{}));
  if (!settings_.kernel) {
    std::erase_if(families_, [](const EvaluationFamily& family) { return family.uses_kernel; });
  }
  const int most = settings_.families > 0 ? settings_.families : 1000;
  if (static_cast<int>(families_.size()) > most) families_.resize(static_cast<std::size_t>(most));
  if (settings_.shapes.empty() || settings_.quick) return absl::OkStatus();
  say_("making families of meshes");
  MORTISE_ASSIGN_OR_RETURN(std::vector<EvaluationFamily> made,
                           MeshFamilies(settings_.shapes, most, say_));
  for (EvaluationFamily& family : made) families_.push_back(std::move(family));
  return absl::OkStatus();
}

absl::Status Study::LoadShapes() {
  if (!settings_.shapes.empty()) {
    say_("reading labelled shapes");
    MORTISE_ASSIGN_OR_RETURN(shapes_, ReadLabelledShapes(settings_.shapes));
    return absl::OkStatus();
  }
  for (const EvaluationFamily& family : families_) {
    for (RandomDesign& design : RandomDesigns(family, kStandIns, settings_.seed + 1)) {
      shapes_.push_back({.name = absl::StrCat(family.name, " ", shapes_.size()),
                         .category = family.category,
                         .author = absl::StrCat("author ", shapes_.size() % kStandIns),
                         .surface = std::move(design.surface)});
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<const std::vector<Eigen::VectorXd>*> Study::Described(std::size_t descriptor) {
  const auto known = described_.find(descriptor);
  if (known != described_.end()) return &known->second;
  const Descriptor& by = *descriptors_[descriptor];
  say_(absl::StrCat("describing labelled shapes by ", by.properties().name));
  std::vector<absl::StatusOr<Eigen::VectorXd>> vectors(shapes_.size(), Eigen::VectorXd());
  ParallelFor(static_cast<int>(shapes_.size()), settings_.threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    vectors[at] = by.Describe(shapes_[at].surface);
  });
  std::vector<Eigen::VectorXd>& described = described_[descriptor];
  for (absl::StatusOr<Eigen::VectorXd>& vector : vectors) {
    MORTISE_RETURN_IF_ERROR(vector.status());
    described.push_back(*std::move(vector));
  }
  return &described;
}

absl::Status Study::CoverAll(std::size_t descriptor) {
  const std::shared_ptr<const Descriptor>& by = descriptors_[descriptor];
  // Without a race: the derivatives of tangents that lose cost more than is gained here.
  CoverOptions options{.seed = settings_.seed,
                       .rejections = effort_.rejections,
                       .race = false,
                       .most_primitives = effort_.most_primitives,
                       .most_evaluations = effort_.most_evaluations};
  if (settings_.points) {
    options.kind = CoverKind::kPoints;
    options.most_primitives = 5 * effort_.most_primitives;
  }
  const FamilyCovers covers(settings_.out / "kept", options);
  std::vector<double> deltas;
  for (const double each : effort_.deltas) deltas.push_back(DeltaOf(*by, each));
  using Made = absl::StatusOr<std::vector<std::vector<Primitive>>>;
  std::vector<Made> made(families_.size(), absl::UnknownError(""));
  ParallelFor(static_cast<int>(families_.size()), settings_.threads, [&](int i) {
    const EvaluationFamily& family = families_[static_cast<std::size_t>(i)];
    say_(absl::StrCat("covering ", family.name, " by ", by->properties().name));
    made[static_cast<std::size_t>(i)] = covers.Of(family, by, deltas);
  });
  for (std::size_t d = 0; d < deltas.size(); ++d) {
    std::vector<FamilyCover>& all = covers_[{descriptor, effort_.deltas[d]}];
    for (std::size_t i = 0; i < made.size(); ++i) {
      all.push_back({.family = static_cast<int>(i), .primitives = {}});
      if (made[i].ok()) {
        all.back().primitives = (*made[i])[d];
      } else if (d == 0) {
        say_(absl::StrCat(families_[i].name, ": ", made[i].status().message()));
      }
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<const std::vector<FamilyCover>*> Study::Covers(std::size_t descriptor,
                                                              double delta) {
  const DeltaKey key{descriptor, delta};
  if (!covers_.contains(key)) MORTISE_RETURN_IF_ERROR(CoverAll(descriptor));
  const auto found = covers_.find(key);
  if (found == covers_.end()) return InvalidField("delta", "is none of the study's");
  return &found->second;
}

absl::StatusOr<const PrimitiveIndex*> Study::Manifolds(std::size_t descriptor, double delta) {
  const auto known = manifolds_.find({descriptor, delta});
  if (known != manifolds_.end()) return &known->second;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FamilyCover>* covers, Covers(descriptor, delta));
  std::vector<FamilyCover> covered;
  for (const FamilyCover& each : *covers) {
    if (!each.primitives.empty()) covered.push_back(each);
  }
  MORTISE_ASSIGN_OR_RETURN(PrimitiveIndex index, PrimitiveIndex::Build(std::move(covered)));
  return &manifolds_.emplace(DeltaKey{descriptor, delta}, std::move(index)).first->second;
}

absl::StatusOr<const PrimitiveIndex*> Study::MeanShapes(std::size_t descriptor) {
  const auto known = mean_shapes_.find(descriptor);
  if (known != mean_shapes_.end()) return &known->second;
  std::vector<FamilyCover> points;
  for (std::size_t i = 0; i < families_.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh surface, MeanShape(families_[i]));
    MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd vector, descriptors_[descriptor]->Describe(surface));
    Primitive point{.parameters = Eigen::VectorXd(0),
                    .center = std::move(vector),
                    .axes = Eigen::MatrixXd(),
                    .radii = Eigen::VectorXd(0)};
    point.axes.resize(point.center.size(), 0);
    points.push_back({.family = static_cast<int>(i), .primitives = {std::move(point)}});
  }
  MORTISE_ASSIGN_OR_RETURN(PrimitiveIndex index, PrimitiveIndex::Build(std::move(points)));
  return &mean_shapes_.emplace(descriptor, std::move(index)).first->second;
}

absl::StatusOr<std::vector<IndexMatch>> Study::Search(
    const PrimitiveIndex& index, std::size_t descriptor, const Eigen::VectorXd& vector, int count,
    const std::function<bool(int family)>& allowed) const {
  IndexQuery query{.descriptors = {}, .count = count, .allowed = allowed};
  const Eigen::MatrixXd turns = descriptors_[descriptor]->QuarterTurns(vector);
  for (const auto& turn : turns.colwise()) query.descriptors.emplace_back(turn);
  return index.Nearest(query);
}

}  // namespace mortise::retrieval
