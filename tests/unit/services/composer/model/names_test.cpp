// Names stay distinct, and rows stay rows by their names.
#include "services/composer/model/names.h"

#include <gtest/gtest.h>

namespace mortise::composer {
namespace {

parametric::Assembly Named(const std::vector<std::string>& parts,
                           const std::vector<std::string>& groups) {
  parametric::Assembly assembly;
  assembly.groups.push_back({"root", -1});
  for (const std::string& group : groups) assembly.groups.push_back({group, 0});
  for (const std::string& part : parts) assembly.parts.emplace_back().name = part;
  return assembly;
}

TEST(NamesTest, WhatIsFreeStays) {
  const ComponentNames names =
      NamesInModel(Named({"side 1"}, {"case"}), Named({"shelf 1"}, {"shelves"}), "c");
  EXPECT_EQ(names.root, "c");
  EXPECT_EQ(names.parts.at("shelf 1"), "shelf 1");
  EXPECT_EQ(names.groups.at("shelves"), "shelves");
  EXPECT_EQ(names.groups.count("root"), 0U);
}

TEST(NamesTest, IfOneIsTakenAllGetTheIdBeforeThem) {
  const ComponentNames names =
      NamesInModel(Named({"shelf 2"}, {"case"}), Named({"shelf 1", "shelf 2"}, {"shelves"}), "top");
  EXPECT_EQ(names.parts.at("shelf 1"), "top shelf 1");
  EXPECT_EQ(names.parts.at("shelf 2"), "top shelf 2");
  EXPECT_EQ(names.groups.at("shelves"), "top shelves");
}

TEST(NamesTest, WhatIsTakenEvenSoIsNumbered) {
  const ComponentNames names = NamesInModel(Named({"shelf", "top shelf"}, {"top"}),
                                            Named({"shelf", "top shelf"}, {}), "top");
  EXPECT_EQ(names.root, "top (2)");
  EXPECT_EQ(names.parts.at("shelf"), "top shelf (2)");
  EXPECT_EQ(names.parts.at("top shelf"), "top top shelf");
}

TEST(NamesTest, NumbersGoOnUntilOneIsFree) {
  std::set<std::string> taken = {"a", "a (2)"};
  EXPECT_EQ(TakeName("a", taken), "a (3)");
  EXPECT_EQ(TakeName("a", taken), "a (4)");
  EXPECT_EQ(TakeName("b", taken), "b");
}

}  // namespace
}  // namespace mortise::composer
