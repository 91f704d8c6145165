// Indexes that were damaged, written by an earlier version, or whose build was cancelled: never
// answered from, and mended by building again.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/retrieval/retrieval_house.h"

namespace mortise::retrieval {
namespace {

using testing::BuiltState;
using testing::Call;
using testing::kCoarse;
using testing::RetrievalHouse;
using testing::Value;

v1::SearchShapesRequest ForTable() {
  v1::SearchShapesRequest request;
  request.mutable_design()->set_template_("templates/table");
  *request.mutable_design()->add_parameters() = Value("length", 1.7);
  return request;
}

// The file of a blob in the state of a service.
std::filesystem::path FileOf(const std::string& digest, const std::filesystem::path& state) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(state / "blobs")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = entry.path().filename().string();
    if (digest.size() >= name.size() && digest.ends_with(name) && name.size() > 32) {
      return entry.path();
    }
  }
  ADD_FAILURE() << "no blob " << digest;
  return {};
}

// Changes a byte where it lies.
void Flip(const std::filesystem::path& path, std::uintmax_t at) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekg(static_cast<std::streamoff>(at));
  const char byte = static_cast<char>(file.get());
  file.seekp(static_cast<std::streamoff>(at));
  file.put(static_cast<char>(byte ^ 0x10));
  ASSERT_TRUE(file.good()) << path;
}

void ExpectDamaged(const absl::StatusOr<v1::SearchShapesResponse>& found) {
  EXPECT_EQ(found.status().code(), absl::StatusCode::kFailedPrecondition) << found.status();
  EXPECT_EQ(DetailOf(found.status()).reason, "INDEX_DAMAGED") << found.status();
}

TEST(IndexFaultsTest, ADamagedIndexIsNotAnsweredFromUntilItIsBuiltAgain) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  const auto index = house.Index();
  ASSERT_TRUE(index.ok()) << index.status();
  const auto before = house.Search(ForTable());
  ASSERT_TRUE(before.ok()) << before.status();
  const auto path = FileOf(index->sha256(), house.service().folder());
  const std::uintmax_t size = std::filesystem::file_size(path);
  const std::pair<const char*, std::function<void()>> damages[] = {
      {"number", [&] { Flip(path, size / 2); }},
      {"version", [&] { Flip(path, 8); }},
      {"end", [&] { std::filesystem::resize_file(path, size / 3); }},
      {"all", [&] { std::filesystem::remove(path); }}};
  for (const auto& [what, damage] : damages) {
    SCOPED_TRACE(what);
    damage();
    ExpectDamaged(house.Search(ForTable()));
    EXPECT_NE(house.Index()->fault(), "") << "its state tells, too";
    house.KillAndStart();
    ExpectDamaged(house.Search(ForTable()));
    house.Build(what, kCoarse);
    EXPECT_EQ(house.Index()->sha256(), index->sha256());
    EXPECT_EQ(house.Index()->fault(), "");
    const auto after = house.Search(ForTable());
    ASSERT_TRUE(after.ok()) << after.status();
    EXPECT_EQ(after->SerializeAsString(), before->SerializeAsString());
  }
}

TEST(IndexFaultsTest, ADamagedCoverIsMadeAgain) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  const std::string digest = house.Index()->sha256();
  // The index's, and the smaller of the two covers'.
  std::filesystem::path smallest;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(house.service().folder() / "blobs")) {
    if (!entry.is_regular_file()) continue;
    if (smallest.empty() || entry.file_size() < std::filesystem::file_size(smallest)) {
      smallest = entry.path();
    }
  }
  Flip(smallest, std::filesystem::file_size(smallest) - 1);
  const auto path = FileOf(digest, house.service().folder());
  Flip(path, std::filesystem::file_size(path) - 1);
  ExpectDamaged(house.Search(ForTable()));
  house.Build("again", kCoarse);
  EXPECT_EQ(house.Index()->sha256(), digest);
  EXPECT_TRUE(house.Search(ForTable()).ok());
}

// Takes what this version says of templates out of the records of an index and its covers.
void MakeOld(const std::filesystem::path& state) {
  const auto store =
      store::OpenStore({.url = "sqlite:" + (state / "store.db").string(), .service = "retrieval"});
  ASSERT_TRUE(store.ok()) << store.status();
  const absl::Status changed = (*store)->Transact([](store::Transaction& transaction) {
    for (const char* kind : {"indexes", "covers"}) {
      MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                               transaction.List(kind, {.limit = 100}));
      for (const store::Record& record : records) {
        v1::ShapeIndex index;
        EXPECT_TRUE(index.ParseFromString(record.payload));
        index.clear_format_version();
        for (v1::ShapeIndex::Family& family : *index.mutable_families()) {
          family.clear_title();
          family.clear_parameters();
          family.clear_items();
          family.clear_materials();
          family.clear_labels();
          family.clear_creator();
          family.clear_create_time();
        }
        MORTISE_RETURN_IF_ERROR(
            transaction.Put(kind, record.key, index.SerializeAsString()).status());
      }
    }
    return absl::OkStatus();
  });
  ASSERT_TRUE(changed.ok()) << changed;
}

TEST(IndexFaultsTest, AnIndexOfAnEarlierVersionIsPutTogetherAnewFromItsCovers) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  const auto before = house.Search(ForTable());
  ASSERT_TRUE(before.ok()) << before.status();
  const auto evaluations = house.Index()->families(0).evaluations();
  house.service().Kill();
  MakeOld(house.service().folder());
  house.KillAndStart();
  const auto early = house.Search(ForTable());
  if (!early.ok()) {
    EXPECT_EQ(DetailOf(early.status()).reason, "INDEX_OUTDATED") << early.status();
  }
  // The service brings it up by itself.
  grpc::ClientContext context;
  testing::Prepare(context);
  v1::FollowEventsRequest follow;
  follow.set_after_number(0);
  follow.add_type_prefixes("index.");
  const auto stub = v1::EventService::NewStub(house.channel());
  const auto events = stub->FollowEvents(&context, follow);
  for (v1::Event event; events->Read(&event);) {
    if (house.Index()->format_version() > 0 && house.Index()->current()) break;
  }
  context.TryCancel();
  const auto after = house.Search(ForTable());
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ(after->SerializeAsString(), before->SerializeAsString());
  EXPECT_EQ(house.Index()->families(0).evaluations(), evaluations) << "covered again";
}

TEST(IndexFaultsTest, ACancelledBuildLeavesTheIndexAsItWas) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  const auto before = house.Index();
  ASSERT_TRUE(before.ok()) << before.status();
  v1::BuildIndexRequest request;
  request.set_request_id("finer");
  request.add_shape_descriptors(v1::D2);
  request.set_delta(0.02);  // takes minutes
  const auto started = house.StartBuild(request);
  ASSERT_TRUE(started.ok()) << started.status();
  const auto operations = v1::OperationService::NewStub(house.channel());
  v1::CancelOperationRequest cancel;
  cancel.set_request_id("no-more");
  cancel.set_name(started->name());
  const auto asked = Call(*operations, &v1::OperationService::Stub::CancelOperation, cancel);
  ASSERT_TRUE(asked.ok()) << asked.status();
  const auto done = house.Await(started->name());
  ASSERT_TRUE(done.ok()) << done.status();
  EXPECT_EQ(done->state(), v1::Operation::CANCELLED) << done->ShortDebugString();
  EXPECT_EQ(house.Index()->SerializeAsString(), before->SerializeAsString());
  EXPECT_TRUE(house.Search(ForTable()).ok());
}

}  // namespace
}  // namespace mortise::retrieval
