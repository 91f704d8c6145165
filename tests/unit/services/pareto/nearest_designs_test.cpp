// Nearest designs among many, against looking at all of them.
#include "services/pareto/nearest_designs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "services/pareto/random.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Anywhere(Eigen::Index size, Random& random) {
  VectorXd u(size);
  for (double& value : u) value = random.Uniform();
  return u;
}

std::vector<std::size_t> ByLookingAtAll(const MatrixXd& designs, std::size_t known,
                                        const VectorXd& u, const VectorXd& weights,
                                        std::size_t count) {
  std::vector<std::pair<double, std::size_t>> all;
  for (std::size_t i = 0; i < known; ++i)
    all.emplace_back(
        (designs.col(static_cast<Eigen::Index>(i)) - u).cwiseProduct(weights).squaredNorm(), i);
  std::ranges::sort(all);
  std::vector<std::size_t> nearest;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) nearest.push_back(all[i].second);
  return nearest;
}

void ExpectSameAsLookingAtAll(const MatrixXd& designs, Random& random) {
  const Eigen::Index size = designs.rows();
  const NearestDesigns::Designs view(designs.data(), size, designs.cols());
  NearestDesigns nearest;
  EXPECT_TRUE(nearest.Nearest(VectorXd::Zero(size), VectorXd::Ones(size), 3, view).empty());
  for (std::size_t known = 1; known <= static_cast<std::size_t>(designs.cols()); ++known) {
    nearest.Add(known - 1, view);
    if (known > 20 && known % 37 != 0) continue;
    const VectorXd weights = VectorXd::Ones(size) + 20 * Anywhere(size, random);
    const VectorXd u = known % 2 == 0 ? Anywhere(size, random) : VectorXd(designs.col(0));
    for (const std::size_t count : {1u, 7u, 60u})
      ASSERT_EQ(nearest.Nearest(u, weights, count, view),
                ByLookingAtAll(designs, known, u, weights, count));
  }
}

TEST(NearestDesigns, AreThoseThatLookingAtAllFinds) {
  Random random(4);
  MatrixXd everywhere(5, 400), along(5, 400), lattice(3, 343);
  for (auto column : everywhere.colwise()) column = Anywhere(5, random);
  // Near a line in the fourth parameter.
  for (auto column : along.colwise()) {
    column = VectorXd::Constant(5, 0.3) + 1e-3 * Anywhere(5, random);
    column[3] = random.Uniform();
  }
  // Many are equally near.
  for (Eigen::Index i = 0; i < lattice.cols(); ++i)
    lattice.col(i) = Eigen::Vector3d(i % 7, (i / 7) % 7, i / 49) / 6;
  ExpectSameAsLookingAtAll(everywhere, random);
  ExpectSameAsLookingAtAll(along, random);
  ExpectSameAsLookingAtAll(lattice, random);
}

}  // namespace
}  // namespace mortise::pareto
