// Keys of the bus, made once and read by every process.
#include "common/bus/key_folder.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/temporary_folder.h"

namespace mortise::bus {
namespace {

TEST(KeyFolder, GivesBrokerAndClientsMatchingKeys) {
  const mortise::testing::TemporaryFolder folder;
  ASSERT_TRUE(CreateCurveKey(folder.path(), "gateway").ok());
  ASSERT_TRUE(CreateCurveKey(folder.path(), "catalog").ok());
  const BrokerSecurity broker = LoadBrokerSecurity(folder.path(), "gateway").value();
  const ClientSecurity client = LoadClientSecurity(folder.path(), "catalog", "gateway").value();
  ASSERT_TRUE(broker.keys && client.keys);
  EXPECT_EQ(client.broker_key, broker.keys->public_key);
  EXPECT_EQ(broker.allowed_clients.size(), 2u);
  EXPECT_NE(std::find(broker.allowed_clients.begin(), broker.allowed_clients.end(),
                      client.keys->public_key),
            broker.allowed_clients.end());
  EXPECT_TRUE(CheckSecurity(broker, {"tcp://0.0.0.0:7790"}).ok());
  EXPECT_TRUE(CheckSecurity(client, "tcp://gateway:7790").ok());
}

TEST(KeyFolder, SecretKeysAreForTheOwnerOnly) {
  const mortise::testing::TemporaryFolder folder;
  ASSERT_TRUE(CreateCurveKey(folder.path(), "gateway").ok());
  const auto permissions =
      std::filesystem::status(folder.path() / "gateway.curve-secret").permissions();
  EXPECT_EQ(permissions & (std::filesystem::perms::group_all | std::filesystem::perms::others_all),
            std::filesystem::perms::none);
}

TEST(KeyFolder, KeepsTheKeysThatAreThere) {
  const mortise::testing::TemporaryFolder folder;
  ASSERT_TRUE(CreateCurveKey(folder.path(), "gateway").ok());
  EXPECT_TRUE(absl::IsAlreadyExists(CreateCurveKey(folder.path(), "gateway")));
}

TEST(KeyFolder, WithoutKeysTheBusIsPlainAndStaysOnTheMachine) {
  const mortise::testing::TemporaryFolder folder;
  const ClientSecurity client = LoadClientSecurity(folder.path(), "catalog", "gateway").value();
  EXPECT_FALSE(client.keys);
  EXPECT_FALSE(CheckSecurity(client, "tcp://gateway:7790").ok());
}

TEST(KeyFolder, NamesTheFileThatIsMissing) {
  const mortise::testing::TemporaryFolder folder;
  ASSERT_TRUE(CreateCurveKey(folder.path(), "catalog").ok());
  const absl::Status status = LoadClientSecurity(folder.path(), "catalog", "gateway").status();
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message().find("gateway.curve-public"), absl::string_view::npos);
}

}  // namespace
}  // namespace mortise::bus
