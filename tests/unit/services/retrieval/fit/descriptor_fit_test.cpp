#include "services/retrieval/fit/descriptor_fit.h"

#include <gtest/gtest.h>

#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector4d;
using Eigen::VectorXd;

FitFamily Chairs() {
  FitFamily family;
  family.surfaces.lower = Vector4d(0.35, 0.35, 0.35, 0.3);
  family.surfaces.upper = Vector4d(0.6, 0.6, 0.55, 0.6);
  family.surfaces.surface = [](const VectorXd& q) {
    return Chair(Vector4d(q[0], q[1], q[2], q[3]));
  };
  return family;
}

TEST(DescriptorFitTest, ComesNearerByTheDescriptor) {
  const FitFamily family = Chairs();
  const Vector4d hidden(0.42, 0.53, 0.4, 0.5), start(0.5, 0.45, 0.45, 0.4);
  for (const std::string name : {"d2", "voxel"}) {
    const auto descriptor = MakeDescriptor(name);
    ASSERT_TRUE(descriptor.ok());
    std::vector<VectorXd> query;
    const VectorXd vector = *(*descriptor)->Describe(Chair(hidden));
    const Eigen::MatrixXd turns = (*descriptor)->QuarterTurns(vector);
    for (const auto& turned : turns.colwise()) query.emplace_back(turned);
    const auto nearer =
        NearerByDescriptor(**descriptor, query, family, *MakeMember(family, start, 1), 1);
    ASSERT_TRUE(nearer.ok()) << nearer.status();
    const auto distance = [&](const VectorXd& q) {
      const Vector4d at = q;
      return (*descriptor)->Distance(vector, *(*descriptor)->Describe(Chair(at)));
    };
    EXPECT_LT(distance(*nearer), 0.5 * distance(start)) << name;
    EXPECT_TRUE((nearer->array() >= family.surfaces.lower.array() - 1e-12).all());
    EXPECT_TRUE((nearer->array() <= family.surfaces.upper.array() + 1e-12).all());
  }
}

TEST(DescriptorFitTest, StaysWhereItCannotComeNearer) {
  const FitFamily family = Chairs();
  const Vector4d hidden(0.42, 0.53, 0.4, 0.5);
  const auto descriptor = MakeDescriptor("d2");
  ASSERT_TRUE(descriptor.ok());
  const auto bound = (*descriptor)->Bind(Chair(hidden));
  ASSERT_TRUE(bound.ok());
  const VectorXd vector = *(*bound)->Describe(Chair(hidden).vertices);
  const auto same =
      NearerByDescriptor(**descriptor, {vector}, family, *MakeMember(family, hidden, 1), 1);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_LT((*same - hidden).norm(), 1e-6);
}

}  // namespace
}  // namespace mortise::retrieval
