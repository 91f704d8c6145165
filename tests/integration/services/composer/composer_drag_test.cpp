// Dragging live: over a stream, and by calls that store nothing, over gRPC and as JSON through the
// gateway; mortise-composer as a real process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "tests/e2e/http_post.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using Stub = v1::ComposerService::Stub;
using ::testing::HasSubstr;

constexpr double kSame = 1e-9;  // m

template <typename T>
T Good(const absl::StatusOr<T>& status_or) {
  EXPECT_TRUE(status_or.ok()) << status_or.status();
  return status_or.value_or(T());
}

// Boxes of parts by name, as a client keeps them.
using Boxes = std::map<std::string, std::vector<double>>;

template <typename Part>
std::vector<double> BoxOf(const Part& part) {
  return {part.minimum().x(), part.minimum().y(), part.minimum().z(),
          part.maximum().x(), part.maximum().y(), part.maximum().z()};
}

Boxes BoxesOf(const v1::Model& model) {
  Boxes boxes;
  for (const v1::ModelPart& part : model.parts()) boxes[part.name()] = BoxOf(part);
  return boxes;
}

void Apply(const v1::DragPreview& preview, Boxes* boxes) {
  for (const std::string& name : preview.removed()) EXPECT_EQ(boxes->erase(name), 1u) << name;
  for (const v1::MovedPart& part : preview.moved()) {
    EXPECT_EQ(boxes->count(part.name()), 1u) << part.name();
    (*boxes)[part.name()] = BoxOf(part);
  }
  for (const v1::ModelPart& part : preview.added()) {
    EXPECT_EQ(boxes->count(part.name()), 0u) << part.name();
    (*boxes)[part.name()] = BoxOf(part);
  }
}

void ExpectSame(const Boxes& a, const Boxes& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, box] : a) {
    const auto found = b.find(name);
    ASSERT_NE(found, b.end()) << name;
    // Answers leave out what moves by less than a nanometre, each time.
    for (std::size_t i = 0; i < box.size(); ++i) EXPECT_NEAR(box[i], found->second[i], 3 * kSame);
  }
}

// A client of DragNode.
class DragClient {
 public:
  explicit DragClient(Stub& stub) {
    Prepare(context_);
    stream_ = stub.DragNode(&context_);
  }

  void Begin(const v1::Model& model, const std::string& node, const std::string& control) {
    v1::DragNodeRequest request;
    request.mutable_begin()->set_name(model.name());
    request.mutable_begin()->set_revision(model.revision());
    request.mutable_begin()->set_node(node);
    request.mutable_begin()->set_control(control);
    stream_->Write(request);
  }
  bool To(std::int64_t sequence, double value) {
    v1::DragNodeRequest request;
    request.mutable_to()->set_sequence(sequence);
    request.mutable_to()->set_value(value);
    return stream_->Write(request);
  }
  void Commit(const std::string& request_id, double value) {
    v1::DragNodeRequest request;
    request.mutable_commit()->set_request_id(request_id);
    request.mutable_commit()->set_value(value);
    stream_->Write(request);
  }
  std::optional<v1::DragNodeResponse> Read() {
    v1::DragNodeResponse response;
    if (!stream_->Read(&response)) return std::nullopt;
    return response;
  }
  void Close() { stream_->WritesDone(); }
  void BreakOff() { context_.TryCancel(); }
  absl::Status End() { return rpc::FromGrpc(stream_->Finish()); }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::DragNodeRequest, v1::DragNodeResponse>> stream_;
};

class ComposerDragTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  static v1::Model Bookshelf(const std::string& id) {
    const v1::Model empty = house_->New(id);
    return Good(house_->Add(empty, "bookshelf", "", "shelf"));
  }

  static v1::PreviewDragRequest Asking(const v1::Model& model, double value) {
    v1::PreviewDragRequest request;
    request.set_name(model.name());
    request.set_revision(model.revision());
    request.set_control("width");
    request.set_value(value);
    return request;
  }

  static absl::StatusOr<v1::DragPreview> Preview(const v1::PreviewDragRequest& request) {
    return Call(house_->composer(), &Stub::PreviewDrag, request);
  }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerDragTest::house_;

TEST_F(ComposerDragTest, APreviewTellsWhatADragWouldDo) {
  const v1::Model model = Bookshelf("previewed");
  Boxes boxes = BoxesOf(model);
  const v1::DragPreview wide = Good(Preview(Asking(model, 1.2)));
  EXPECT_NEAR(wide.reached(), 1.2, kSame);
  EXPECT_GT(wide.moved_size(), 0);
  Apply(wide, &boxes);
  // From there on to another value: what the caller has is what it names.
  v1::PreviewDragRequest on = Asking(model, 0.8);
  on.set_since_value(1.2);
  Apply(Good(Preview(on)), &boxes);
  EXPECT_EQ(Good(house_->Get(model.name())).SerializeAsString(), model.SerializeAsString());
  const v1::Model dragged = Good(house_->Drag(model, "", "width", 0.8));
  ExpectSame(boxes, BoxesOf(dragged));
  EXPECT_EQ(DetailOf(Preview(Asking(model, 1)).status()).reason, "STALE_REVISION");
  v1::PreviewDragRequest bad = Asking(dragged, 1);
  bad.set_control("colour");
  EXPECT_EQ(DetailOf(Preview(bad).status()).field, "control");
  bad.set_control("width");
  bad.set_node("cellar");
  EXPECT_EQ(DetailOf(Preview(bad).status()).field, "node");
}

// Whatever order values come in, commit stores what DragControl would have, as one step.
TEST_F(ComposerDragTest, AStreamAnswersAndStoresAtItsEnd) {
  const v1::Model model = Bookshelf("streamed");
  const v1::Model twin = Bookshelf("streamed-twin");
  Boxes boxes = BoxesOf(model);
  DragClient client(house_->composer());
  client.Begin(model, "", "width");
  const auto begun = client.Read();
  ASSERT_TRUE(begun && begun->has_begun());
  EXPECT_NEAR(begun->begun().value(), 0.9, kSame);
  std::int64_t sequence = 0;
  for (const double value : {1.2, 0.7, 9.0, 1.1}) {
    ASSERT_TRUE(client.To(++sequence, value));
    const auto moved = client.Read();
    ASSERT_TRUE(moved && moved->has_moved());
    EXPECT_EQ(moved->moved().sequence(), sequence);
    Apply(moved->moved().preview(), &boxes);
  }
  EXPECT_EQ(Good(house_->Get(model.name())).revision(), model.revision());
  client.Commit("commit-streamed", 1.1);
  const auto committed = client.Read();
  ASSERT_TRUE(committed && committed->has_committed());
  const v1::Model& after = committed->committed();
  EXPECT_FALSE(client.Read());
  EXPECT_TRUE(client.End().ok());
  ExpectSame(boxes, BoxesOf(after));
  EXPECT_EQ(after.revision(), model.revision() + 1);
  EXPECT_EQ(after.undo_steps(), model.undo_steps() + 1);
  const v1::Model plain = Good(house_->Drag(twin, "", "width", 1.1));
  EXPECT_EQ(after.digest(), plain.digest());
  EXPECT_EQ(after.last_step(), plain.last_step());
  EXPECT_EQ(Good(house_->Undo(after)).digest(), model.digest());
}

// Far more values than can be answered: those that are answered are in order, and the last one is
// among them.
TEST_F(ComposerDragTest, OfValuesThatComeTooFastTheLatestIsAnswered) {
  constexpr int kValues = 10000;
  const v1::Model model = Bookshelf("hasty");
  Boxes boxes = BoxesOf(model);
  DragClient client(house_->composer());
  client.Begin(model, "", "width");
  ASSERT_TRUE(client.Read());
  for (int i = 1; i <= kValues; ++i) ASSERT_TRUE(client.To(i, 0.8 + 0.4 * i / kValues));
  client.Close();
  std::int64_t last = 0;
  int answers = 0;
  while (const auto moved = client.Read()) {
    ASSERT_TRUE(moved->has_moved());
    EXPECT_GT(moved->moved().sequence(), last);
    last = moved->moved().sequence();
    Apply(moved->moved().preview(), &boxes);
    ++answers;
  }
  EXPECT_TRUE(client.End().ok());
  EXPECT_EQ(last, kValues);
  EXPECT_LT(answers, kValues);
  Boxes direct = BoxesOf(model);
  Apply(Good(Preview(Asking(model, 1.2))), &direct);
  ExpectSame(boxes, direct);
}

TEST_F(ComposerDragTest, AStreamThatBreaksOffLeavesNoTrace) {
  const v1::Model model = Bookshelf("broken-off");
  {
    DragClient client(house_->composer());
    client.Begin(model, "", "width");
    ASSERT_TRUE(client.Read());
    ASSERT_TRUE(client.To(1, 1.4));
    ASSERT_TRUE(client.Read());
    client.BreakOff();
    EXPECT_EQ(client.End().code(), absl::StatusCode::kCancelled);
  }
  EXPECT_EQ(Good(house_->Get(model.name())).SerializeAsString(), model.SerializeAsString());
}

TEST_F(ComposerDragTest, AChangeMeanwhileIsNotOverwritten) {
  const v1::Model model = Bookshelf("contested-drag");
  DragClient client(house_->composer());
  client.Begin(model, "", "width");
  ASSERT_TRUE(client.Read());
  const v1::Model other = Good(house_->Drag(model, "", "height", 1.5));
  ASSERT_TRUE(client.To(1, 1.4));
  ASSERT_TRUE(client.Read());
  client.Commit("commit-contested", 1.4);
  EXPECT_FALSE(client.Read());
  const absl::Status refused = client.End();
  EXPECT_EQ(refused.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(refused).reason, "STALE_REVISION");
  EXPECT_EQ(Good(house_->Get(model.name())).digest(), other.digest());
}

TEST_F(ComposerDragTest, MessagesOutOfOrderAreRefused) {
  const v1::Model model = Bookshelf("disordered");
  const auto refusal = [&](const auto& send) {
    DragClient client(house_->composer());
    send(client);
    client.Close();
    while (client.Read()) {
    }
    return client.End();
  };
  EXPECT_EQ(DetailOf(refusal([](DragClient& client) { client.To(1, 1); })).field, "message");
  EXPECT_EQ(DetailOf(refusal([](DragClient&) {})).field, "message");
  EXPECT_EQ(DetailOf(refusal([&](DragClient& client) {
              client.Begin(model, "", "width");
              client.Begin(model, "", "width");
            })).field,
            "message");
  EXPECT_EQ(DetailOf(refusal([&](DragClient& client) { client.Begin(model, "", "colour"); })).field,
            "control");
  EXPECT_EQ(DetailOf(refusal([&](DragClient& client) {
              client.Begin(model, "", "width");
              client.Commit("", 1);
            })).field,
            "request_id");
  v1::Model gone = model;
  gone.set_name("models/none");
  EXPECT_EQ(refusal([&](DragClient& client) { client.Begin(gone, "", "width"); }).code(),
            absl::StatusCode::kNotFound);
}

// Clients without gRPC drag by calls.
TEST_F(ComposerDragTest, JsonClientsDragThroughTheGateway) {
  const v1::Model model = Bookshelf("through-json");
  TemporaryFolder folder;
  const auto ports = folder.path() / "gateway.json";
  const ServiceProcess gateway(
      BuiltProgram("mortise-gateway"),
      {"--insecure-development", "--log-level=warning", "--grpc=127.0.0.1:0", "--http=127.0.0.1:0",
       "--service=composer=" + house_->composer_address(),
       "--store=sqlite:" + (folder.path() / "gateway.db").string()},
      ports);
  const auto addresses = nlohmann::json::parse(ReadFile(ports.string()).value());
  const std::string http = addresses["http"];
  const auto post = [&](double value) {
    const nlohmann::json body = {{"name", model.name()},
                                 {"revision", model.revision()},
                                 {"control", "width"},
                                 {"value", value}};
    const e2e::HttpAnswer answer =
        e2e::Post(http, "/mortise.v1.ComposerService/PreviewDrag", "application/json", body.dump());
    EXPECT_EQ(answer.status, 200) << answer.body;
    return nlohmann::json::parse(answer.body, nullptr, false);
  };
  const auto answer = post(1.15);
  EXPECT_NEAR(answer["reached"].get<double>(), 1.15, kSame);
  EXPECT_EQ(static_cast<int>(answer["moved"].size()),
            Good(Preview(Asking(model, 1.15))).moved_size());
  // Both ways over HTTP there is no stream, which is said.
  const e2e::HttpAnswer stream =
      e2e::Post(http, "/mortise.v1.ComposerService/DragNode", "application/connect+json", "");
  EXPECT_EQ(stream.status, 505);
  EXPECT_THAT(stream.body, HasSubstr("gRPC"));
}

}  // namespace
}  // namespace mortise::testing
