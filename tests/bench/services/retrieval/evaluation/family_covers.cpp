#include "tests/bench/services/retrieval/evaluation/family_covers.h"

#include <cstring>
#include <optional>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "services/retrieval/families/family_manifold.h"
#include "tests/bench/services/retrieval/evaluation/remembering_manifold.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;

constexpr std::size_t kDigestSize = 64;

// Numbers one after the other, and their digest: what is kept of a cover. An index of each would
// take longer to build than many covers.
class Numbers {
 public:
  void Add(double number) { numbers_.push_back(number); }
  void Add(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
    Add(static_cast<double>(matrix.rows()));
    Add(static_cast<double>(matrix.cols()));
    for (const double number : matrix.reshaped()) Add(number);
  }

  double Next() { return numbers_[next_++]; }
  Eigen::MatrixXd NextMatrix() {
    const auto rows = static_cast<Index>(Next()), columns = static_cast<Index>(Next());
    Eigen::MatrixXd matrix(rows, columns);
    for (double& number : matrix.reshaped()) number = Next();
    return matrix;
  }
  bool AtEnd() const { return next_ >= numbers_.size(); }

  absl::Status Write(const std::filesystem::path& path) const {
    const std::string bytes(reinterpret_cast<const char*>(numbers_.data()),
                            numbers_.size() * sizeof(double));
    return WriteFile(path, absl::StrCat(Sha256Hex(bytes), bytes));
  }

  // Nothing for a file that is not there or not as it was written.
  static std::optional<Numbers> Read(const std::filesystem::path& path) {
    const absl::StatusOr<std::string> file = ReadFile(path);
    if (!file.ok() || file->size() < kDigestSize) return std::nullopt;
    const std::string bytes = file->substr(kDigestSize);
    if (Sha256Hex(bytes) != file->substr(0, kDigestSize)) return std::nullopt;
    Numbers numbers;
    numbers.numbers_.resize(bytes.size() / sizeof(double));
    std::memcpy(numbers.numbers_.data(), bytes.data(), bytes.size());
    return numbers;
  }

 private:
  std::vector<double> numbers_;
  std::size_t next_ = 0;
};

absl::Status WriteCover(const std::vector<Primitive>& primitives,
                        const std::filesystem::path& path) {
  Numbers numbers;
  for (const Primitive& primitive : primitives) {
    numbers.Add(primitive.structure);
    numbers.Add(primitive.parameters);
    numbers.Add(primitive.center);
    numbers.Add(primitive.axes);
    numbers.Add(primitive.radii);
  }
  return numbers.Write(path);
}

std::optional<std::vector<Primitive>> ReadCover(const std::filesystem::path& path) {
  std::optional<Numbers> numbers = Numbers::Read(path);
  if (!numbers) return std::nullopt;
  std::vector<Primitive> primitives;
  while (!numbers->AtEnd()) {
    Primitive& primitive = primitives.emplace_back();
    primitive.structure = static_cast<int>(numbers->Next());
    primitive.parameters = numbers->NextMatrix();
    primitive.center = numbers->NextMatrix();
    primitive.axes = numbers->NextMatrix();
    primitive.radii = numbers->NextMatrix();
  }
  return primitives;
}

}  // namespace

std::filesystem::path FamilyCovers::PathOf(const EvaluationFamily& family,
                                           const Descriptor& descriptor, double delta) const {
  const std::string content = absl::StrJoin(
      std::make_tuple(family.name, family.design_template->head().digest,
                      descriptor.properties().name, descriptor.properties().dimension,
                      absl::StrFormat("%a", delta), options_.rejections, options_.most_primitives,
                      options_.most_evaluations, options_.seed, static_cast<int>(options_.kind)),
      " ");
  return folder_ / absl::StrCat("cover-", Sha256Hex(content).substr(0, 24));
}

absl::StatusOr<std::vector<std::vector<Primitive>>> FamilyCovers::Of(
    const EvaluationFamily& family, const std::shared_ptr<const Descriptor>& descriptor,
    const std::vector<double>& deltas) const {
  std::unique_ptr<Manifold> manifold;
  std::vector<std::vector<Primitive>> covers;
  for (const double delta : deltas) {
    const std::filesystem::path path = PathOf(family, *descriptor, delta);
    if (std::optional<std::vector<Primitive>> kept = ReadCover(path)) {
      covers.push_back(*std::move(kept));
      continue;
    }
    if (!manifold) {
      MORTISE_ASSIGN_OR_RETURN(manifold, MakeFamilyManifold(family.design_template, descriptor));
      manifold = std::make_unique<RememberingManifold>(std::move(manifold));
    }
    CoverOptions options = options_;
    options.delta = delta;
    MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverManifold(*manifold, options));
    MORTISE_RETURN_IF_ERROR(WriteCover(cover.primitives, path));
    covers.push_back(std::move(cover.primitives));
  }
  return covers;
}

}  // namespace mortise::retrieval
