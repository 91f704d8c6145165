// Covers with the look of real ones: every family a few patches of low dimension in descriptor
// space, covered by points and by tangents of one to three axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <vector>

#include "common/base/random.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval::testing {

// What random covers look like.
struct CoverLook {
  int families = 60;
  int primitives = 20;          // of each
  Eigen::Index dimension = 24;  // N
  double spread = 1;            // how far families are apart
  double extent = 0.5;          // of a family
  double radius = 0.1;          // of tangents, about
};

// `count` orthonormal columns.
inline Eigen::MatrixXd RandomAxes(Eigen::Index dimension, Eigen::Index count, Random* random) {
  Eigen::MatrixXd span(dimension, std::max<Eigen::Index>(count, 1));
  for (auto column : span.colwise()) column = random->UnitVector(dimension);
  const Eigen::MatrixXd thin = Eigen::MatrixXd::Identity(dimension, span.cols());
  return (Eigen::HouseholderQR<Eigen::MatrixXd>(span).householderQ() * thin).leftCols(count);
}

// A vector whose later coordinates are ever smaller, as descriptors after a principal-component
// analysis are.
inline Eigen::VectorXd RandomDescriptor(Eigen::Index dimension, Random* random) {
  Eigen::VectorXd x(dimension);
  for (Eigen::Index i = 0; i < dimension; ++i)
    x[i] = random->Normal() / (1 + 0.5 * static_cast<double>(i));
  return x;
}

inline std::vector<FamilyCover> RandomCovers(const CoverLook& look, Random* random) {
  std::vector<FamilyCover> covers;
  for (int family = 0; family < look.families; ++family) {
    FamilyCover cover{.family = family, .primitives = {}};
    const Eigen::VectorXd middle = look.spread * RandomDescriptor(look.dimension, random);
    const Eigen::MatrixXd patch = RandomAxes(look.dimension, 3, random);
    for (int i = 0; i < look.primitives; ++i) {
      const auto axes = static_cast<Eigen::Index>(4 * random->Uniform());
      Eigen::VectorXd at(3), radii(axes);
      for (double& value : at) value = look.extent * (2 * random->Uniform() - 1);
      for (double& radius : radii) radius = look.radius * (0.5 + random->Uniform());
      cover.primitives.push_back({.parameters = at,
                                  .center = middle + patch * at,
                                  .axes = patch.leftCols(axes),
                                  .radii = radii,
                                  .structure = i % 2});
    }
    covers.push_back(std::move(cover));
  }
  return covers;
}

// `copies` of each family, whose centres are moved by about `jitter`.
inline std::vector<FamilyCover> Jittered(const std::vector<FamilyCover>& covers, int copies,
                                         double jitter, Random* random) {
  std::vector<FamilyCover> all;
  for (int copy = 0; copy < copies; ++copy) {
    for (const FamilyCover& cover : covers) {
      all.push_back(cover);
      all.back().family = static_cast<int>(all.size()) - 1;
      if (copy == 0) continue;
      const Eigen::VectorXd move =
          jitter * RandomDescriptor(cover.primitives[0].center.size(), random);
      for (Primitive& primitive : all.back().primitives) primitive.center += move;
    }
  }
  return all;
}

}  // namespace mortise::retrieval::testing
