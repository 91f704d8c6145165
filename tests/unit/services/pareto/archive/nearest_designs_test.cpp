// Nearest designs among many, against looking at all of them.
#include "services/pareto/archive/nearest_designs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Anywhere(Eigen::Index size, Random& random) {
  VectorXd u(size);
  for (double& value : u) value = random.Uniform();
  return u;
}

std::vector<std::size_t> ByLookingAtAll(const MatrixXd& designs,
                                        const std::vector<std::size_t>& known, const VectorXd& u,
                                        const VectorXd& weights, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> all;
  for (const std::size_t i : known) {
    const VectorXd apart = designs.col(static_cast<Eigen::Index>(i)) - u;
    all.emplace_back(apart.cwiseProduct(weights).squaredNorm(), i);
  }
  std::ranges::sort(all);
  std::vector<std::size_t> nearest;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) nearest.push_back(all[i].second);
  return nearest;
}

// With every third design left out.
void ExpectSameAsLookingAtAll(const MatrixXd& designs, bool weighted, Random& random) {
  const Eigen::Index size = designs.rows();
  const NearestDesigns::Designs view(designs.data(), size, designs.cols());
  NearestDesigns nearest;
  EXPECT_TRUE(nearest.Nearest(VectorXd::Zero(size), VectorXd::Ones(size), 3, view).empty());
  std::vector<std::size_t> known;
  for (std::size_t number = 0; number < static_cast<std::size_t>(designs.cols()); ++number) {
    if (number % 3 == 2) continue;
    nearest.Add(number, view);
    known.push_back(number);
    if (known.size() > 20 && known.size() % 37 != 0) continue;
    VectorXd weights = VectorXd::Ones(size);
    if (weighted) weights += 20 * Anywhere(size, random);
    const auto middle = static_cast<Eigen::Index>(known[known.size() / 2]);
    const VectorXd u =
        known.size() % 2 == 0 ? Anywhere(size, random) : VectorXd(designs.col(middle));
    for (const std::size_t count : {1u, 7u, 60u}) {
      ASSERT_EQ(nearest.Nearest(u, weights, count, view),
                ByLookingAtAll(designs, known, u, weights, count));
    }
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
  for (Eigen::Index i = 0; i < lattice.cols(); ++i) {
    lattice.col(i) = Eigen::Vector3d(i % 7, (i / 7) % 7, i / 49) / 6;
  }
  ExpectSameAsLookingAtAll(everywhere, true, random);
  ExpectSameAsLookingAtAll(along, true, random);
  ExpectSameAsLookingAtAll(lattice, false, random);
}

}  // namespace
}  // namespace mortise::pareto
