// Drawings that are imported again, looked at after a restart, or given up: through the catalog as
// a process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "common/rpc/status_mapping.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_service_fixture.h"
#include "tests/support/round_parts.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr char kBearing[] = "assemblies/bearing";

class AssemblyReimportTest : public AssemblyServiceTest {
 protected:
  v1::ImportAssemblyStepRequest Request(const std::string& step, const std::string& name,
                                        int64_t expected = 0) {
    v1::ImportAssemblyStepRequest request;
    request.set_request_id("import-" + std::to_string(++requests_));
    request.set_step(step);
    request.mutable_annotations()->set_name(name);
    request.set_expected_revision(expected);
    return request;
  }

  const std::string bearing_ = testing::BearingStep();
};

TEST_F(AssemblyReimportTest, KeepsAnnotationsUnlessToldToDropThem) {
  v1::ImportAssemblyStepRequest annotated = Request(bearing_, kBearing);
  annotated.mutable_annotations()->set_title("Plain bearing");
  v1::PartAnnotation& collars = *annotated.mutable_annotations()->add_parts();
  collars.add_parts("collar left");
  collars.add_parts("collar right");
  collars.set_role(v1::AssemblyPart::CONNECTING);
  collars.set_title("Collar");
  ASSERT_OK(Call(&Stub::ImportAssemblyStep, annotated).status());
  const v1::Assembly first = Get(kBearing);

  ASSERT_OK_AND_ASSIGN(const auto again,
                       Call(&Stub::ImportAssemblyStep, Request(bearing_, kBearing, 1)));
  EXPECT_EQ(again.assembly().revision(), 1) << "nothing has changed";
  EXPECT_EQ(again.assembly().DebugString(), first.DebugString());
  EXPECT_THAT(again.notes(), Contains(AllOf(HasSubstr("kept the annotations of revision 1"),
                                            HasSubstr("collar left, collar right"))));

  v1::ImportAssemblyStepRequest dropping = Request(bearing_, kBearing, 1);
  dropping.mutable_annotations()->add_parts()->add_parts("*");
  ASSERT_OK_AND_ASSIGN(const auto bare, Call(&Stub::ImportAssemblyStep, dropping));
  EXPECT_EQ(bare.assembly().revision(), 2);
  EXPECT_EQ(bare.assembly().title(), "bearing") << "as the drawing is called";
  for (const v1::AssemblyPart& part : bare.assembly().parts()) {
    EXPECT_NE(part.role(), v1::AssemblyPart::CONNECTING) << part.name();
    EXPECT_EQ(part.title(), "");
  }
}

TEST_F(AssemblyReimportTest, LooksTheSameAfterARestart) {
  ASSERT_OK(Call(&Stub::ImportAssemblyStep, Request(bearing_, kBearing)).status());
  const v1::Parametrization before = ParametrizationOf(kBearing);
  EXPECT_EQ(before.elements_size(), 7);
  EXPECT_GE(before.contacts_size(), 7);
  process_.Kill();
  process_.Start();
  Connect();
  EXPECT_EQ(ParametrizationOf(kBearing).SerializeAsString(), before.SerializeAsString());
}

TEST_F(AssemblyReimportTest, TellsHowFarItIsAndLeavesNothingWhenItIsGivenUp) {
  const v1::ImportAssemblyStepRequest request =
      Request(testing::PinBoardStep(58), "assemblies/pin-board");
  const auto events = v1::EventService::NewStub(process_.channel());
  grpc::ClientContext following;
  v1::FollowEventsRequest follow;
  follow.add_streams("catalog");
  follow.add_type_prefixes("assembly.importing");
  const auto reader = events->FollowEvents(&following, follow);

  grpc::ClientContext importing;
  testing::Prepare(importing);
  v1::ImportAssemblyStepResponse response;
  grpc::Status ended;
  std::jthread call([&] {
    ended = stub_->ImportAssemblyStep(&importing, request, &response);
    following.TryCancel();
  });
  v1::Event event;
  ASSERT_TRUE(reader->Read(&event)) << "the import tells nothing";
  EXPECT_EQ(event.type(), "assembly.importing");
  EXPECT_EQ(event.subject(), "assemblies/pin-board");
  const auto data = nlohmann::json::parse(event.data());
  EXPECT_EQ(data["request_id"], request.request_id());
  EXPECT_NE(data["stage"], "");
  EXPECT_LE(data["done"], data["total"]);
  importing.TryCancel();
  call.join();
  reader->Finish();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::CANCELLED);

  v1::GetAssemblyRequest get;
  get.set_name("assemblies/pin-board");
  EXPECT_TRUE(absl::IsNotFound(Call(&Stub::GetAssembly, get).status()));
}

}  // namespace
}  // namespace mortise::catalog
