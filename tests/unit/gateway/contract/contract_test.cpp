// Routing tables made from the protos.
#include "gateway/contract/contract.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise::gateway {
namespace {

class ContractTest : public testing::Test {
 protected:
  const std::unique_ptr<const Contract> contract_ = Contract::Load();
};

TEST_F(ContractTest, RoutesMethodsToTheServiceOfTheirFile) {
  const MethodRoute* method = contract_->Find("/mortise.v1.CatalogService/GetItem");
  ASSERT_NE(method, nullptr);
  EXPECT_EQ(method->service, "catalog");
  EXPECT_EQ(method->destination, Destination::kService);
  EXPECT_EQ(method->role, 1);
  EXPECT_FALSE(method->mutates);
  EXPECT_EQ(contract_->Find("/mortise.v1.EvaluatorService/EvaluateBatch")->service, "simulator");
  EXPECT_EQ(contract_->Find("/mortise.v1.AssemblyService/AdjustAssembly")->service, "catalog");
  EXPECT_EQ(contract_->Find("/mortise.v1.WebhookService/CreateWebhook")->service, "gateway");
}

TEST_F(ContractTest, RoutesOperationsAndStreamsByWhatTheyName) {
  EXPECT_EQ(contract_->Find("/mortise.v1.OperationService/WatchOperation")->destination,
            Destination::kByOperation);
  EXPECT_EQ(contract_->Find("/mortise.v1.EventService/ReadEvents")->destination,
            Destination::kByStream);
  EXPECT_EQ(contract_->Find("/mortise.v1.OperationService/ListOperations")->service, "gateway");
  EXPECT_EQ(contract_->Find("/mortise.v1.EventService/FollowEvents")->service, "gateway");
  EXPECT_EQ(ServiceOfOperation("operations/pareto/0198"), "pareto");
  for (const char* bad : {"", "operations", "operations/", "operations/pareto",
                          "operations/pareto/", "operations//x", "plans/pareto/x"}) {
    EXPECT_EQ(ServiceOfOperation(bad), "") << bad;
  }
}

TEST_F(ContractTest, EveryMethodDeclaresWhoMayCallIt) {
  for (const MethodRoute& method : contract_->methods()) {
    EXPECT_GT(method.role, 0) << method.full_name;
    EXPECT_EQ(contract_->Find(method.path), &method);
  }
}

TEST_F(ContractTest, KnowsTheServices) {
  EXPECT_THAT(contract_->services(),
              testing::IsSupersetOf({"catalog", "simulator", "pareto", "fabplanner"}));
  EXPECT_THAT(contract_->services(), testing::Not(testing::Contains("gateway")));
  EXPECT_EQ(contract_->Find("/mortise.v1.CatalogService/Nothing"), nullptr);
  EXPECT_EQ(contract_->Find(""), nullptr);
}

}  // namespace
}  // namespace mortise::gateway
