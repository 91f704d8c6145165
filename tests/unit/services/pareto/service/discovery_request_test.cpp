// What discovery operations keep as their request, now and in stores of earlier versions.
#include "services/pareto/service/discovery_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

v1::DiscoverySpecification Specification() {
  v1::DiscoverySpecification specification;
  specification.set_subject("templates/table");
  specification.set_revision(3);
  for (const char* metric : {"mass", "compliance"}) {
    specification.add_objectives()->set_metric(metric);
  }
  specification.add_bounds()->set_parameter("length");
  specification.set_evaluations(200);
  specification.mutable_mesh()->set_element_size(0.02);
  specification.add_start_from("fronts/earlier");
  return specification;
}

TEST(DiscoveryRequest, IsReadWithItsTags) {
  v1::DiscoverFrontRequest request;
  *request.mutable_specification() = Specification();
  request.set_request_id("r-1");
  request.add_external_ids("100-4711/A");
  (*request.mutable_labels())["project"] = "kitchen";
  const auto read = ReadDiscoveryRequest("operations/pareto/o1", request.SerializeAsString());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->specification().SerializeAsString(), Specification().SerializeAsString());
  EXPECT_THAT(read->external_ids(), testing::ElementsAre("100-4711/A"));
  EXPECT_EQ(read->labels().at("project"), "kitchen");
}

TEST(DiscoveryRequest, IsReadWhereASpecificationAloneWasStored) {
  const auto read =
      ReadDiscoveryRequest("operations/pareto/o1", Specification().SerializeAsString());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->specification().SerializeAsString(), Specification().SerializeAsString());
  EXPECT_THAT(read->external_ids(), testing::IsEmpty());
  EXPECT_TRUE(read->labels().empty());
}

TEST(DiscoveryRequest, ThatIsDamagedIsToldWithItsOperation) {
  const auto read = ReadDiscoveryRequest("operations/pareto/o1", "\xff\xff");
  EXPECT_EQ(DetailOf(read.status()).reason, "STORAGE_FAILED");
  EXPECT_THAT(std::string(read.status().message()), testing::HasSubstr("operations/pareto/o1"));
}

}  // namespace
}  // namespace mortise::pareto
