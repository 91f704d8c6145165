// The history of models: every state comes back as it was, and nobody's change is lost.
#include "services/composer/records/model_records.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/records/drawing_records.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::composer {
namespace {

const resources::Author kAda = {.user = "users/ada", .trace_id = ""};

// A state that can be told from others by the id of its only component.
ModelState StateWith(const std::string& component) {
  ModelState state;
  state.mutable_shown()->add_components()->set_id(component);
  v1::ModelPart* const part = state.mutable_shown()->add_parts();
  part->set_name("board");
  part->set_component(component);
  return state;
}

class ModelRecordsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = store::OpenStore({.url = "sqlite:" + (folder_.path() / "s.db").string()});
    ASSERT_OK(opened.status());
    store_ = *std::move(opened);
    v1::Model head;
    head.set_title("Desk");
    ASSERT_OK(Change([&](store::Transaction& transaction) {
      return CreateRecord(transaction, "desk", head, ModelState(), "new", kAda);
    }));
  }

  absl::StatusOr<StoredModel> Change(
      const std::function<absl::StatusOr<StoredModel>(store::Transaction&)>& change) {
    absl::StatusOr<StoredModel> result = absl::UnknownError("");
    const absl::Status status = store_->Transact([&](store::Transaction& transaction) {
      result = change(transaction);
      return result.status();
    });
    if (!status.ok()) return status;
    return result;
  }

  StoredModel Present() {
    const auto present = ReadModel(*store_, "models/desk");
    EXPECT_OK(present.status());
    return *present;
  }

  absl::StatusOr<StoredModel> Add(const v1::Model& seen, const std::string& component) {
    return Change([&](store::Transaction& transaction) {
      return AddStep(transaction, seen, StateWith(component), "add " + component, kAda);
    });
  }

  absl::StatusOr<StoredModel> Move(HistoryMove move) {
    return Change([&](store::Transaction& transaction) {
      return MoveInHistory(transaction, "models/desk", Present().head.revision(), move, kAda);
    });
  }

  // How many records of a kind there are.
  std::size_t Count(const char* kind) {
    std::size_t count = 0;
    EXPECT_OK(store_->Read([&](store::ReadTransaction& transaction) {
      count = transaction.List(kind, {})->size();
      return absl::OkStatus();
    }));
    return count;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_;
};

TEST_F(ModelRecordsTest, UndoAndRedoGiveEachStateAgain) {
  std::vector<std::string> digests = {Present().head.digest()};
  for (const char* const component : {"one", "two", "three"}) {
    const auto added = Add(Present().head, component);
    ASSERT_OK(added.status());
    digests.push_back(added->head.digest());
  }
  for (int step = 2; step >= 0; --step) {
    const auto undone = Move(HistoryMove::kUndo);
    ASSERT_OK(undone.status());
    EXPECT_EQ(undone->head.digest(), digests[static_cast<std::size_t>(step)]);
    EXPECT_EQ(undone->head.undo_steps(), step);
    EXPECT_EQ(undone->head.redo_steps(), 3 - step);
  }
  EXPECT_EQ(DetailOf(Move(HistoryMove::kUndo).status()).reason, "NOTHING_TO_UNDO");
  EXPECT_EQ(Present().state.shown().components_size(), 0);
  for (std::size_t step = 1; step < digests.size(); ++step) {
    const auto redone = Move(HistoryMove::kRedo);
    ASSERT_OK(redone.status());
    EXPECT_EQ(redone->head.digest(), digests[step]);
  }
  EXPECT_EQ(DetailOf(Move(HistoryMove::kRedo).status()).reason, "NOTHING_TO_REDO");
  EXPECT_EQ(Present().state.shown().components(0).id(), "three");
  EXPECT_EQ(Present().head.revision(), 10);
}

TEST_F(ModelRecordsTest, ANewStepTakesThePlaceOfWhatWasUndone) {
  ASSERT_OK(Add(Present().head, "one").status());
  ASSERT_OK(Add(Present().head, "two").status());
  ASSERT_OK(Move(HistoryMove::kUndo).status());
  ASSERT_OK(Move(HistoryMove::kUndo).status());
  const auto other = Add(Present().head, "other");
  ASSERT_OK(other.status());
  EXPECT_EQ(other->head.undo_steps(), 1);
  EXPECT_EQ(other->head.redo_steps(), 0);
  EXPECT_EQ(DetailOf(Move(HistoryMove::kRedo).status()).reason, "NOTHING_TO_REDO");
  EXPECT_EQ(Present().state.shown().components(0).id(), "other");
}

TEST_F(ModelRecordsTest, OfTwoWritersOneIsToldOfThePresentRevision) {
  const v1::Model seen = Present().head;
  ASSERT_OK(Add(seen, "one").status());
  const absl::Status late = Add(seen, "two").status();
  EXPECT_EQ(late.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(late).reason, "STALE_REVISION");
  EXPECT_EQ(Present().state.shown().components(0).id(), "one");
  EXPECT_EQ(ReadModelAt(*store_, "models/desk", 1).status().code(), absl::StatusCode::kAborted);
  ASSERT_OK(ReadModelAt(*store_, "models/desk", 2).status());
}

TEST_F(ModelRecordsTest, TagsAreNoContent) {
  const v1::Model seen = Present().head;
  StoredModel tagged = Present();
  tagged.head.add_external_ids("100-4711/A");
  ASSERT_OK(Change([&](store::Transaction& transaction) -> absl::StatusOr<StoredModel> {
              const absl::Status put = PutHead(transaction, tagged.head, kAda);
              if (!put.ok()) return put;
              return tagged;
            }).status());
  const auto added = Add(seen, "one");
  ASSERT_OK(added.status());
  EXPECT_EQ(added->head.external_ids_size(), 1);
}

TEST_F(ModelRecordsTest, NothingStaysOfADeletedModel) {
  ASSERT_OK(Add(Present().head, "one").status());
  Drawing drawing;
  drawing.bundle.mutable_assembly()->add_parts()->set_shape("shapes/00");
  drawing.bundle.add_shapes()->set_name("shapes/00");
  drawing.digest = "11";
  ASSERT_OK(store_->Transact([&](store::Transaction& transaction) {
    return PutDrawing(transaction, "models/desk", drawing);
  }));
  const absl::Status stale = store_->Transact([&](store::Transaction& transaction) {
    return DeleteRecords(transaction, "models/desk", 1, kAda);
  });
  EXPECT_EQ(stale.code(), absl::StatusCode::kAborted);
  ASSERT_OK(store_->Transact([&](store::Transaction& transaction) {
    return DeleteRecords(transaction, "models/desk", 2, kAda);
  }));
  for (const char* const kind : {"models", "modelSteps", kDrawings, kShapes}) {
    EXPECT_EQ(Count(kind), 0u) << kind;
  }
  EXPECT_EQ(ReadModel(*store_, "models/desk").status().code(), absl::StatusCode::kNotFound);
}

TEST_F(ModelRecordsTest, AnIdIsGivenOnce) {
  const auto again = Change([&](store::Transaction& transaction) {
    return CreateRecord(transaction, "desk", v1::Model(), ModelState(), "new", kAda);
  });
  EXPECT_EQ(again.status().code(), absl::StatusCode::kAlreadyExists);
}

}  // namespace
}  // namespace mortise::composer
