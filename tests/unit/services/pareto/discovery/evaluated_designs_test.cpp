#include "services/pareto/discovery/evaluated_designs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mortise::pareto {
namespace {

std::size_t AddDesign(Archive& archive, double first, double second) {
  ArchiveEntry entry;
  entry.u = Eigen::Vector2d(first, second);
  return archive.Add(std::move(entry));
}

TEST(EvaluatedDesignsTest, FindsADesignToTheLastBitAndNoOther) {
  Archive archive;
  EvaluatedDesigns designs;
  const std::size_t first = AddDesign(archive, 0.1, 0.2);
  const std::size_t second = AddDesign(archive, 0.2, 0.1);
  for (const std::size_t entry : {first, second}) designs.Add(archive, entry);
  EXPECT_EQ(designs.Find(archive, Eigen::Vector2d(0.1, 0.2)), first);
  EXPECT_EQ(designs.Find(archive, Eigen::Vector2d(0.2, 0.1)), second);
  const double next = std::nextafter(0.1, 1.0);
  EXPECT_EQ(designs.Find(archive, Eigen::Vector2d(next, 0.2)), std::nullopt);
}

TEST(EvaluatedDesignsTest, TakesBothZerosForTheSame) {
  Archive archive;
  EvaluatedDesigns designs;
  designs.Add(archive, AddDesign(archive, -0.0, 1));
  EXPECT_EQ(designs.Find(archive, Eigen::Vector2d(0.0, 1)), 0u);
}

TEST(EvaluatedDesignsTest, GivesTheFirstOfSeveralEntriesOfOneDesign) {
  Archive archive;
  EvaluatedDesigns designs;
  for (int i = 0; i < 3; ++i) designs.Add(archive, AddDesign(archive, 0.5, 0.5));
  EXPECT_EQ(designs.Find(archive, Eigen::Vector2d(0.5, 0.5)), 0u);
}

}  // namespace
}  // namespace mortise::pareto
