// How transactions go that begin with their first statement.
#include "common/store/postgresql_connection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/private_postgresql.h"

namespace mortise::store {
namespace {

using ::testing::HasSubstr;

constexpr char kBegin[] = "BEGIN ISOLATION LEVEL READ COMMITTED";

class PostgresqlConnectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto server = testing::PrivatePostgresql::Start();
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    connection_ = Open();
    ASSERT_EQ(connection_->Execute("CREATE SCHEMA probe; CREATE TABLE counts (n BIGINT UNIQUE)"),
              absl::OkStatus());
  }

  std::unique_ptr<PostgresqlConnection> Open() const {
    auto connection = PostgresqlConnection::Open(server_->url(), "probe");
    EXPECT_TRUE(connection.ok()) << connection.status();
    return *std::move(connection);
  }

  // What another connection sees.
  int64_t Seen() const {
    const auto other = Open();
    const auto result = other->Run("SELECT COUNT(*) FROM counts", {});
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? result->rows[0][0].integer : -1;
  }

  absl::Status Insert(int64_t n) {
    return connection_->Run("INSERT INTO counts VALUES ($1)", {n}).status();
  }

  std::unique_ptr<testing::PrivatePostgresql> server_;
  std::unique_ptr<PostgresqlConnection> connection_;
};

TEST_F(PostgresqlConnectionTest, StatementsTakeEffectTogetherAtTheCommit) {
  for (int round = 0; round < 2; ++round) {  // prepared, and again
    ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
    EXPECT_EQ(Insert(2 * round), absl::OkStatus());
    EXPECT_EQ(Insert(2 * round + 1), absl::OkStatus());
    EXPECT_EQ(Seen(), 2 * round);
    EXPECT_EQ(connection_->Commit(), absl::OkStatus());
    EXPECT_EQ(Seen(), 2 * (round + 1));
  }
}

TEST_F(PostgresqlConnectionTest, AFirstStatementIsRolledBack) {
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  EXPECT_EQ(Insert(1), absl::OkStatus());
  connection_->Rollback();
  EXPECT_EQ(Seen(), 0);
}

TEST_F(PostgresqlConnectionTest, ATransactionOfNothingEndsEitherWay) {
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  EXPECT_EQ(connection_->Commit(), absl::OkStatus());
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  connection_->Rollback();
  EXPECT_EQ(Insert(1), absl::OkStatus());
  EXPECT_EQ(Seen(), 1) << "there was no transaction any more";
}

TEST_F(PostgresqlConnectionTest, AFirstStatementThatFailsSaysWhyAndLeavesNothing) {
  ASSERT_EQ(Insert(7), absl::OkStatus());
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  const absl::Status twice = Insert(7);
  EXPECT_THAT(twice.message(), HasSubstr("duplicate key"));
  EXPECT_TRUE(connection_->repeatable());
  EXPECT_EQ(Insert(8), twice) << "nothing goes on in a transaction that failed";
  connection_->Rollback();
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  EXPECT_EQ(Insert(8), absl::OkStatus());
  EXPECT_EQ(connection_->Commit(), absl::OkStatus());
  EXPECT_EQ(Seen(), 2);
}

TEST_F(PostgresqlConnectionTest, ABeginningThatFailsSaysWhy) {
  ASSERT_EQ(connection_->Begin("BEGIN ISOLATION LEVEL IMAGINARY"), absl::OkStatus());
  EXPECT_THAT(Insert(1).message(), HasSubstr("syntax error"));
  connection_->Rollback();
  EXPECT_EQ(Seen(), 0);
}

TEST_F(PostgresqlConnectionTest, AConnectionThatIsGoneMayBeUsedAgain) {
  const auto other = Open();
  ASSERT_EQ(other->Execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity"
                           " WHERE pid <> pg_backend_pid() AND backend_type = 'client backend'"),
            absl::OkStatus());
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  EXPECT_TRUE(absl::IsUnavailable(Insert(1)));
  EXPECT_TRUE(connection_->repeatable());
  connection_->Rollback();
  ASSERT_EQ(connection_->Begin(kBegin), absl::OkStatus());
  EXPECT_EQ(Insert(1), absl::OkStatus());
  EXPECT_EQ(connection_->Commit(), absl::OkStatus());
  EXPECT_EQ(Seen(), 1);
}

}  // namespace
}  // namespace mortise::store
