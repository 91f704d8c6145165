// mortise-retrieval as a real process, beside a catalog with a few templates: from no index to the
// templates that a shape can be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/retrieval.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/retrieval/retrieval_house.h"

namespace mortise::retrieval {
namespace {

using testing::BuiltState;
using testing::Call;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kCoarse;
using testing::RetrievalHouse;
using ::testing::UnorderedElementsAre;
using testing::Value;

constexpr double kFine = 0.15;  // δ of an index that tells the two apart

// Searches change nothing: they share an index.
class SearchTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = std::make_unique<RetrievalHouse>();
    house_->Build("shared", kFine);
  }
  static void TearDownTestSuite() { house_.reset(); }

  // The design of a template as an OBJ file.
  static std::string ObjOf(const std::string& name,
                           const std::vector<v1::ParameterValue>& parameters) {
    v1::ExportDesignRequest request;
    request.set_name(name);
    request.mutable_parameters()->Assign(parameters.begin(), parameters.end());
    request.set_format(v1::ExportDesignRequest::OBJ);
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto bytes = testing::ReadChunks(*house_->catalog().ExportDesign(&context, request));
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.value_or("");
  }

  // Sends a file in pieces, the first of which says how large it is; its digest.
  static absl::StatusOr<std::string> Upload(const std::string& file, int64_t declared) {
    constexpr std::size_t kPiece = 512 * 1024;
    grpc::ClientContext context;
    testing::Prepare(context);
    v1::UploadMeshResponse response;
    const auto writer = house_->retrieval().UploadMesh(&context, &response);
    v1::Chunk chunk;
    chunk.set_total_size(declared);
    for (std::size_t at = 0; at < file.size(); at += kPiece) {
      chunk.set_offset(static_cast<int64_t>(at));
      chunk.set_data(file.substr(at, kPiece));
      if (!writer->Write(chunk)) break;
      chunk.Clear();
    }
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    if (!status.ok()) return rpc::FromGrpc(status);
    return response.sha256();
  }

  static absl::StatusOr<v1::SearchShapesResponse> Search(const v1::SearchShapesRequest& request) {
    return house_->Search(request);
  }

  static std::unique_ptr<RetrievalHouse> house_;
};

std::unique_ptr<RetrievalHouse> SearchTest::house_;

TEST_F(SearchTest, FindsTheTemplateThatAMeshWasMadeOf) {
  const auto index = house_->Index();
  ASSERT_TRUE(index.ok()) << index.status();
  std::vector<std::string> names;
  for (const v1::ShapeIndex::Family& family : index->families()) {
    names.push_back(family.template_());
    EXPECT_EQ(family.fault(), "") << family.template_();
    EXPECT_GT(family.points() + family.tangents(), 0) << family.template_();
  }
  EXPECT_THAT(names, UnorderedElementsAre("templates/boat", "templates/table"));
  EXPECT_TRUE(index->current());

  v1::SearchShapesRequest request;
  request.mutable_mesh()->set_file(
      ObjOf("templates/table", {Value("length", 1.6), Value("height", 0.6)}));
  request.mutable_mesh()->set_file_name("table.obj");
  request.mutable_mesh()->set_length_unit("m");
  request.set_with_sheet(true);
  const auto found = Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 2);
  EXPECT_EQ(found->matches(0).template_(), "templates/table");
  EXPECT_LE(found->matches(0).distance(), index->delta());
  EXPECT_LT(found->matches(0).distance(), found->matches(1).distance());
  EXPECT_EQ(found->matches(0).parameters_size(), 6);
  EXPECT_EQ(found->sheet().substr(1, 3), "PNG");
}

TEST_F(SearchTest, TakesMeshesThatOutgrowAMessage) {
  std::string file = ObjOf("templates/table", {Value("length", 1.6)});
  file.insert(0, std::string(5'000'000, '#') + "\n");
  const auto uploaded = Upload(file, static_cast<int64_t>(file.size()));
  ASSERT_TRUE(uploaded.ok()) << uploaded.status();
  v1::SearchShapesRequest request;
  request.mutable_mesh()->set_upload(*uploaded);
  request.mutable_mesh()->set_length_unit("m");
  const auto found = Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->matches(0).template_(), "templates/table");
  request.mutable_mesh()->set_file("v 0 0 0");
  EXPECT_EQ(DetailOf(Search(request).status()).field, "mesh.upload");
  request.mutable_mesh()->clear_file();
  request.mutable_mesh()->set_upload(std::string(64, '0'));
  EXPECT_EQ(DetailOf(Search(request).status()).field, "mesh.upload");
}

TEST_F(SearchTest, RefusesUploadsThatAreTooLargeAtOnce) {
  const absl::Status refused = Upload("# a mesh", int64_t{2} << 30).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted) << refused;
  EXPECT_EQ(DetailOf(Upload("v 0 0 0", 1000).status()).field, "total_size");
}

TEST_F(SearchTest, FindsADesignByTheParametersOfItsMatch) {
  v1::SearchShapesRequest request;
  request.mutable_design()->set_template_("templates/table");
  *request.mutable_design()->add_parameters() = Value("length", 1.9);
  const auto found = Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches(0).template_(), "templates/table");
  // The design that the match tells of is one that the index knows.
  v1::SearchShapesRequest again;
  again.mutable_design()->set_template_("templates/table");
  *again.mutable_design()->mutable_parameters() = found->matches(0).parameters();
  const auto known = Search(again);
  ASSERT_TRUE(known.ok()) << known.status();
  EXPECT_LT(known->matches(0).distance(), 0.06) << "more than the noise of the descriptor";
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(known->matches(0).parameters(i).value(), found->matches(0).parameters(i).value());
  }
}

TEST_F(SearchTest, LooksAmongTheTemplatesThatAreNamed) {
  v1::SearchShapesRequest request;
  request.mutable_design()->set_template_("templates/table");
  request.add_templates("templates/boat");
  const auto only = Search(request);
  ASSERT_TRUE(only.ok()) << only.status();
  ASSERT_EQ(only->matches_size(), 1);
  EXPECT_EQ(only->matches(0).template_(), "templates/boat");
}

TEST_F(SearchTest, NamesWhatIsWrongWithASearch) {
  v1::SearchShapesRequest request;
  EXPECT_EQ(DetailOf(Search(request).status()).field, "query");
  request.mutable_mesh()->set_file("nothing that could be a mesh");
  request.mutable_mesh()->set_length_unit("cubit");
  request.set_limit(-1);
  request.add_templates("items/board");
  const absl::Status refused = Search(request).status();
  std::vector<std::string> fields;
  for (const FieldViolation& each : AllViolationsOf(refused)) fields.push_back(each.field);
  EXPECT_THAT(fields, ElementsAre("limit", "templates[0]", "mesh.length_unit"));
  request = {};
  request.mutable_mesh()->set_file("nothing that could be a mesh");
  EXPECT_EQ(DetailOf(Search(request).status()).field, "mesh.file");
  request.mutable_design()->set_template_("templates/none");
  EXPECT_TRUE(absl::IsNotFound(Search(request).status()));
  request.mutable_design()->set_template_("templates/table");
  request.mutable_design()->add_parts("no such part");
  EXPECT_EQ(DetailOf(Search(request).status()).field, "design.parts");
  request.mutable_design()->clear_parts();
  request.set_shape_descriptor(v1::VOXEL);
  const absl::Status missing = Search(request).status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kFailedPrecondition) << missing;
  EXPECT_EQ(DetailOf(missing).reason, "INDEX_MISSING");
}

TEST(IndexTest, GoesOnWithABuildThatWasKilled) {
  RetrievalHouse house;
  const auto started = house.StartBuild("first", kCoarse);
  ASSERT_TRUE(started.ok()) << started.status();
  house.KillAndStart();
  const auto done = house.Await(started->name());
  ASSERT_TRUE(done.ok()) << done.status();
  ASSERT_EQ(done->state(), v1::Operation::SUCCEEDED) << done->ShortDebugString();
  v1::BuildIndexResponse built;
  ASSERT_TRUE(done->result().UnpackTo(&built));
  const std::string digest = built.indexes(0).sha256();
  EXPECT_EQ(built.indexes(0).family_count(), 2);

  // What is known is not covered again, and gives the same index to the bit.
  const v1::Operation again = house.Build("again", kCoarse);
  ASSERT_TRUE(again.result().UnpackTo(&built));
  EXPECT_EQ(built.indexes(0).sha256(), digest);
}

TEST(IndexTest, IsOfTheTemplatesThatWereNamedAlone) {
  RetrievalHouse house;
  v1::BuildIndexRequest request;
  request.set_request_id("table");
  request.add_shape_descriptors(v1::D2);
  request.set_delta(kCoarse);
  request.add_templates("templates/table");
  house.End(house.StartBuild(request));
  const auto built = house.Index();
  ASSERT_TRUE(built.ok()) << built.status();
  EXPECT_EQ(built->family_count(), 1);
  EXPECT_FALSE(built->every_template());
  EXPECT_TRUE(built->current());

  request.set_request_id("both");
  request.set_refresh(true);
  EXPECT_EQ(DetailOf(house.StartBuild(request).status()).field, "refresh");
  request.set_request_id("again");
  request.clear_templates();
  house.End(house.StartBuild(request));
  EXPECT_EQ(house.Index()->sha256(), built->sha256());
  EXPECT_FALSE(house.Index()->every_template());

  // Covers of another δ are none of this index.
  request.set_request_id("finer");
  request.set_refresh(false);
  request.set_delta(0.9 * kCoarse);
  request.add_templates("templates/boat");
  v1::BuildIndexResponse response;
  ASSERT_TRUE(house.End(house.StartBuild(request)).result().UnpackTo(&response));
  const std::vector<std::string> notes(response.notes().begin(), response.notes().end());
  const auto finer = house.Index();
  ASSERT_EQ(finer->family_count(), 1);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("templates/table")));
  EXPECT_EQ(finer->families(0).template_(), "templates/boat");
}

TEST(IndexTest, IsGoneOnceItIsDeleted) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  v1::SearchShapesRequest search;
  search.mutable_design()->set_template_("templates/table");
  ASSERT_TRUE(house.Search(search).ok());
  v1::DeleteIndexRequest request;
  request.set_request_id("no-more");
  request.set_name("indexes/d2");
  const auto remove = [&] {
    return Call(house.retrieval(), &v1::RetrievalService::Stub::DeleteIndex, request).status();
  };
  EXPECT_TRUE(remove().ok());
  EXPECT_TRUE(absl::IsNotFound(house.Index().status()));
  const absl::Status missing = house.Search(search).status();
  EXPECT_EQ(DetailOf(missing).reason, "INDEX_MISSING") << missing;
  EXPECT_THAT(missing.message(), HasSubstr("mortise index build"));
  request.set_request_id("again");
  EXPECT_TRUE(absl::IsNotFound(remove()));
}

TEST(IndexTest, IsNotMadeOfNothing) {
  RetrievalHouse house;
  v1::BuildIndexRequest request;
  request.set_request_id("none");
  request.add_templates("templates/none");
  EXPECT_TRUE(absl::IsNotFound(house.StartBuild(request).status()));
  request.clear_templates();
  request.add_shape_descriptors(v1::D2);
  request.set_delta(1e9);
  EXPECT_EQ(DetailOf(house.StartBuild(request).status()).field, "delta");
  for (const char* const name : {"templates/boat", "templates/table"}) {
    v1::DeleteTemplateRequest remove;
    remove.set_request_id(name);
    remove.set_name(name);
    remove.set_revision(1);
    ASSERT_TRUE(Call(house.catalog(), &v1::CatalogService::Stub::DeleteTemplate, remove).ok());
  }
  const absl::Status refused = house.StartBuild("empty", kCoarse).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition) << refused;
  EXPECT_EQ(DetailOf(refused).reason, "NO_TEMPLATES");
  EXPECT_TRUE(absl::IsNotFound(house.Index().status()));
}

TEST(IndexTest, IsKeptUpToTheTemplates) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  grpc::ClientContext context;
  testing::Prepare(context);
  v1::FollowEventsRequest follow;
  follow.set_after_number(-1);
  follow.add_type_prefixes("index.");
  const auto stub = v1::EventService::NewStub(house.channel());
  const auto events = stub->FollowEvents(&context, follow);

  v1::DeleteTemplateRequest remove;
  remove.set_request_id("no-boat");
  remove.set_name("templates/boat");
  remove.set_revision(1);
  const auto removed = Call(house.catalog(), &v1::CatalogService::Stub::DeleteTemplate, remove);
  ASSERT_TRUE(removed.ok()) << removed.status();

  v1::ShapeIndex index;
  for (v1::Event event; events->Read(&event);) {
    const auto now = house.Index();
    ASSERT_TRUE(now.ok()) << now.status();
    index = *now;
    if (index.current() && index.family_count() == 1) break;
  }
  context.TryCancel();
  EXPECT_EQ(index.family_count(), 1);
  EXPECT_TRUE(index.current());
}

}  // namespace
}  // namespace mortise::retrieval
