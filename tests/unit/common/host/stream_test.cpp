// Streams through a real server: order, back-pressure, cancellation, files in chunks.
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/host/chunk_stream.h"
#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {
namespace {

// Lets one thread wait for what another has done.
class Signal {
 public:
  void Set() {
    std::lock_guard lock(mutex_);
    set_ = true;
    changed_.notify_all();
  }
  bool Wait() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return set_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool set_ = false;
};

ReadResponse Number(int64_t number) {
  ReadResponse response;
  response.set_number(number);
  return response;
}

class StreamTest : public ProbeServerTest {
 protected:
  struct Received {
    std::vector<int64_t> numbers;
    absl::Status status;
  };

  Received Follow(const ReadRequest& request = {}) {
    auto context = Context(rpc::Role::kViewer);
    auto reader = stub_->Follow(context.get(), request);
    Received received;
    ReadResponse response;
    while (reader->Read(&response)) received.numbers.push_back(response.number());
    received.status = rpc::FromGrpc(reader->Finish());
    return received;
  }
};

TEST_F(StreamTest, SendsInOrderThenTheStatus) {
  handlers_.follow = [](const rpc::Call&, const ReadRequest& request,
                        const ResponseWriter& writer) -> absl::Status {
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(writer->Write(Number(i)));
    writer->Finish(request.name() == "fail" ? StaleRevision("x", 1, 2) : absl::OkStatus());
    EXPECT_FALSE(writer->Write(Number(-1)));
    return absl::OkStatus();
  };
  StartServer();
  Received received = Follow();
  EXPECT_OK(received.status);
  ASSERT_EQ(received.numbers.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(received.numbers[i], i);

  ReadRequest request;
  request.set_name("fail");
  received = Follow(request);
  EXPECT_EQ(received.numbers.size(), 100u);
  EXPECT_EQ(DetailOf(received.status).reason, "STALE_REVISION");
}

TEST_F(StreamTest, AFailureToStartIsTheStatus) {
  handlers_.follow = [](const rpc::Call&, const ReadRequest&, const ResponseWriter&) {
    return ResourceNotFound("operations/x");
  };
  StartServer();
  EXPECT_EQ(Follow().status.code(), absl::StatusCode::kNotFound);
  auto context = rpc::MakeClientContext(As(rpc::Role::kNone));
  ReadResponse response;
  auto reader = stub_->Follow(context.get(), {});
  EXPECT_FALSE(reader->Read(&response));
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::PERMISSION_DENIED);
}

TEST_F(StreamTest, LaterMessagesComeFromAnyThread) {
  ResponseWriter kept;
  Signal started;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    kept = writer;
    started.Set();
    return absl::OkStatus();
  };
  StartServer();
  std::thread source([&] {
    ASSERT_TRUE(started.Wait());
    for (int i = 0; i < 10; ++i) kept->Write(Number(i));
    kept->Finish(absl::OkStatus());
  });
  EXPECT_EQ(Follow().numbers.size(), 10u);
  source.join();
}

TEST_F(StreamTest, LearnsThatTheReaderIsGone) {
  Signal ended;
  ResponseWriter kept;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    writer->OnEnd([&] { ended.Set(); });
    writer->Write(Number(1));
    kept = writer;
    return absl::OkStatus();
  };
  StartServer();
  auto context = Context(rpc::Role::kViewer);
  auto reader = stub_->Follow(context.get(), {});
  ReadResponse response;
  ASSERT_TRUE(reader->Read(&response));
  context->TryCancel();
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
  ASSERT_TRUE(ended.Wait());
  EXPECT_TRUE(kept->cancelled());
  EXPECT_FALSE(kept->Write(Number(2)));
  Signal late;
  kept->OnEnd([&] { late.Set(); });
  EXPECT_TRUE(late.Wait());
}

TEST_F(StreamTest, ASlowReaderIsCutOff) {
  Signal full;
  handlers_.follow_options.capacity = 8;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    ReadResponse big;
    big.set_filler(std::string(100000, 'x'));
    for (int i = 0; i < 100000 && writer->Write(big); ++i) {
    }
    full.Set();
    return absl::OkStatus();
  };
  StartServer();
  auto context = Context(rpc::Role::kViewer);
  auto reader = stub_->Follow(context.get(), {});
  ASSERT_TRUE(full.Wait());
  ReadResponse response;
  while (reader->Read(&response)) {
  }
  const absl::Status status = rpc::FromGrpc(reader->Finish());
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(DetailOf(status).reason, "SLOW_READER");
}

TEST_F(StreamTest, OfStatesOnlyTheLatestWaits) {
  handlers_.follow_options.capacity = 2;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    for (int i = 0; i <= 1000; ++i) EXPECT_TRUE(writer->WriteLatest(Number(i)));
    writer->Finish(absl::OkStatus());
    return absl::OkStatus();
  };
  StartServer();
  const Received received = Follow();
  EXPECT_OK(received.status);
  ASSERT_FALSE(received.numbers.empty());
  EXPECT_EQ(received.numbers.back(), 1000);
}

TEST_F(StreamTest, PullsNoFasterThanTheReader) {
  auto pulled = std::make_shared<std::atomic<int>>(0);
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    writer->Pull([pulled]() -> absl::StatusOr<std::optional<ReadResponse>> {
      ReadResponse response = Number((*pulled)++);
      response.set_filler(std::string(2'000'000, 'x'));
      return std::optional<ReadResponse>(response);
    });
    return absl::OkStatus();
  };
  StartServer();
  auto context = Context(rpc::Role::kViewer);
  auto reader = stub_->Follow(context.get(), {});
  ReadResponse response;
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(reader->Read(&response));
  EXPECT_EQ(response.number(), 49);
  // What gRPC and TCP buffer is some megabytes, the more the busier the machine.
  EXPECT_LT(*pulled, 50 + 40);
  context->TryCancel();
}

TEST_F(StreamTest, APullThatHasNothingWaitsForWake) {
  ResponseWriter kept;
  std::mutex mutex;
  std::vector<int> source;  // guarded by mutex
  Signal asked;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    kept = writer;
    writer->Pull([&]() -> absl::StatusOr<std::optional<ReadResponse>> {
      std::lock_guard lock(mutex);
      asked.Set();
      if (source.empty()) return std::optional<ReadResponse>();
      const int next = source.back();
      source.pop_back();
      if (next < 0) return ResourceNotFound("more");
      return std::optional<ReadResponse>(Number(next));
    });
    return absl::OkStatus();
  };
  StartServer();
  std::thread feeder([&] {
    ASSERT_TRUE(asked.Wait());
    {
      std::lock_guard lock(mutex);
      source = {-1, 2, 1};
    }
    kept->Wake();
  });
  const Received received = Follow();
  feeder.join();
  EXPECT_EQ(received.numbers, (std::vector<int64_t>{1, 2}));
  EXPECT_EQ(received.status.code(), absl::StatusCode::kNotFound);
}

// ---- Files -------------------------------------------------------------------------------------

class FileStreamTest : public StreamTest {
 protected:
  void SetUp() override {
    handlers_.download = [this](const rpc::Call&, const ReadRequest& request,
                                const ChunkWriter& writer) -> absl::Status {
      if (request.text() == "bytes") {
        rpc::StreamBytes(content_, {"a.txt", "text/plain"}, writer);
      } else if (request.text() == "artifact") {
        return rpc::StreamArtifact(*store_->Blobs(), "plans/a", artifacts_, request.name(), writer);
      } else {
        rpc::StreamBlob(*store_->Blobs(), request.name(), {"a.bin", "x/y"}, writer);
      }
      return absl::OkStatus();
    };
    handlers_.upload = [this](const rpc::Call&)
        -> absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, Kept>>> {
      return std::make_unique<Assembly>(*store_->Blobs());
    };
    StartServer();
  }

  class Assembly : public rpc::UploadReader<v1::Chunk, Kept> {
   public:
    explicit Assembly(store::BlobFolder* blobs) : chunks_(blobs, 10'000'000) {}
    absl::Status OnMessage(const v1::Chunk& chunk) override { return chunks_.Append(chunk); }
    absl::StatusOr<Kept> Complete() override {
      MORTISE_ASSIGN_OR_RETURN(const std::string digest, chunks_.Finish());
      Kept kept;
      kept.set_name(digest);
      return kept;
    }

   private:
    rpc::ChunkAssembler chunks_;
  };

  struct Downloaded {
    std::vector<v1::Chunk> chunks;
    std::string bytes;
    absl::Status status;
  };

  Downloaded Download(const ReadRequest& request) {
    auto context = Context(rpc::Role::kViewer);
    auto reader = stub_->Download(context.get(), request);
    Downloaded result;
    v1::Chunk chunk;
    while (reader->Read(&chunk)) {
      EXPECT_EQ(chunk.offset(), static_cast<int64_t>(result.bytes.size()));
      result.bytes += chunk.data();
      result.chunks.push_back(chunk);
    }
    result.status = rpc::FromGrpc(reader->Finish());
    return result;
  }

  absl::StatusOr<Kept> Upload(const std::vector<v1::Chunk>& chunks) {
    auto context = Context(rpc::Role::kDesigner);
    Kept kept;
    auto writer = stub_->Upload(context.get(), &kept);
    for (const v1::Chunk& chunk : chunks) {
      if (!writer->Write(chunk)) break;
    }
    writer->WritesDone();
    const absl::Status status = rpc::FromGrpc(writer->Finish());
    if (!status.ok()) return status;
    return kept;
  }

  static v1::Chunk Piece(int64_t offset, const std::string& data, int64_t total = 0,
                         const std::string& sha256 = "") {
    v1::Chunk chunk;
    chunk.set_offset(offset);
    chunk.set_data(data);
    chunk.set_total_size(total);
    chunk.set_sha256(sha256);
    return chunk;
  }

  std::string content_ = "hello";
  google::protobuf::RepeatedPtrField<v1::Artifact> artifacts_;
};

TEST_F(FileStreamTest, ABlobComesInChunksWithItsDigest) {
  std::string bytes;
  for (int i = 0; i < 3'000'001; ++i) bytes.push_back(static_cast<char>(i * 31 + i / 977));
  ReadRequest request;
  request.set_name(*(*store_->Blobs())->Put(bytes));
  const Downloaded downloaded = Download(request);
  EXPECT_OK(downloaded.status);
  EXPECT_TRUE(downloaded.bytes == bytes);
  ASSERT_EQ(downloaded.chunks.size(), 6u);
  EXPECT_EQ(downloaded.chunks[0].total_size(), 3'000'001);
  EXPECT_EQ(downloaded.chunks[0].sha256(), request.name());
  EXPECT_EQ(downloaded.chunks[0].file_name(), "a.bin");
  EXPECT_EQ(downloaded.chunks[0].media_type(), "x/y");
  EXPECT_EQ(downloaded.chunks[1].sha256(), "");
}

TEST_F(FileStreamTest, AMissingBlobIsNotFound) {
  ReadRequest request;
  request.set_name(std::string(64, 'a'));
  EXPECT_EQ(Download(request).status.code(), absl::StatusCode::kNotFound);
}

TEST_F(FileStreamTest, AnArtifactIsFoundByItsFileName) {
  for (const char* name : {"a.dxf", "b.svg"}) {
    v1::Artifact* artifact = artifacts_.Add();
    artifact->set_file_name(name);
    artifact->set_media_type(std::string("media/") + name);
    artifact->set_sha256(*(*store_->Blobs())->Put(std::string("content of ") + name));
  }
  ReadRequest request;
  request.set_text("artifact");
  request.set_name("b.svg");
  const Downloaded downloaded = Download(request);
  EXPECT_OK(downloaded.status);
  EXPECT_EQ(downloaded.bytes, "content of b.svg");
  EXPECT_EQ(downloaded.chunks.at(0).file_name(), "b.svg");
  EXPECT_EQ(downloaded.chunks.at(0).media_type(), "media/b.svg");

  request.set_name("c.png");
  const absl::Status missing = Download(request).status;
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(DetailOf(missing).field, "plans/a/c.png");

  artifacts_.at(1).set_sha256(std::string(64, 'a'));
  request.set_name("b.svg");
  EXPECT_EQ(Download(request).status.code(), absl::StatusCode::kNotFound) << "its blob is gone";
}

TEST_F(FileStreamTest, BytesAtHandAndEvenNoneAreAFile) {
  ReadRequest request;
  request.set_text("bytes");
  EXPECT_EQ(Download(request).bytes, "hello");
  content_.clear();
  const Downloaded empty = Download(request);
  EXPECT_OK(empty.status);
  ASSERT_EQ(empty.chunks.size(), 1u);
  EXPECT_EQ(empty.chunks[0].sha256(), Sha256Hex(""));
}

TEST_F(FileStreamTest, AnUploadIsPutTogether) {
  const std::string bytes(2'500'000, 'q');
  const std::string digest = Sha256Hex(bytes);
  const auto kept = Upload({Piece(0, bytes.substr(0, 1'000'000), 2'500'000, digest),
                            Piece(1'000'000, bytes.substr(0, 1'000'000)),
                            Piece(2'000'000, bytes.substr(0, 500'000))});
  ASSERT_OK(kept);
  EXPECT_EQ(kept->name(), digest);
  EXPECT_EQ(*(*store_->Blobs())->Get(digest), bytes);
}

TEST_F(FileStreamTest, BadUploadsNameTheField) {
  const auto field = [&](const std::vector<v1::Chunk>& chunks) {
    const absl::Status status = Upload(chunks).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field({}), "data");
  EXPECT_EQ(field({Piece(5, "x", 6)}), "offset");
  EXPECT_EQ(field({Piece(0, "ab", 4), Piece(3, "d")}), "offset");
  EXPECT_EQ(field({Piece(0, "ab", 4)}), "total_size");
  EXPECT_EQ(field({Piece(0, "abcde", 4)}), "data");
  EXPECT_EQ(field({Piece(0, "ab", -4)}), "total_size");
  EXPECT_EQ(field({Piece(0, std::string(1024 * 1024 + 1, 'x'), 2'000'000)}), "data");
  EXPECT_EQ(field({Piece(0, "ab", 2, std::string(64, '0'))}), "sha256");
  EXPECT_EQ((*store_->Blobs())->Size(Sha256Hex("ab")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Upload({Piece(0, "ab", 10'000'001)}).status().code(),
            absl::StatusCode::kResourceExhausted);
}

// ---- Both ways ---------------------------------------------------------------------------------

// Answers each message with its number; "end" finishes, "bad" fails.
class Echo : public rpc::StreamReader<ReadRequest> {
 public:
  Echo(ResponseWriter writer, Signal* ended) : writer_(std::move(writer)), ended_(ended) {}
  absl::Status OnMessage(const ReadRequest& message) override {
    if (message.name() == "bad") return InvalidField("name", "is bad");
    if (message.name() == "end") {
      writer_->Finish(absl::OkStatus());
      return absl::OkStatus();
    }
    writer_->Write(Number(static_cast<int64_t>(message.number())));
    return absl::OkStatus();
  }
  void OnEnd() override {
    writer_->Finish(absl::OkStatus());
    ended_->Set();
  }

 private:
  ResponseWriter writer_;
  Signal* ended_;
};

class ChatTest : public StreamTest {
 protected:
  void SetUp() override {
    handlers_.chat = [this](const rpc::Call&, ResponseWriter writer)
        -> absl::StatusOr<std::unique_ptr<rpc::StreamReader<ReadRequest>>> {
      return std::make_unique<Echo>(std::move(writer), &ended_);
    };
    StartServer(absl::Seconds(20));
    context_ = Context(rpc::Role::kViewer);
    stream_ = stub_->Chat(context_.get());
  }

  void Send(double number, const std::string& name = "") {
    ReadRequest request;
    request.set_number(number);
    request.set_name(name);
    stream_->Write(request);
  }

  Signal ended_;
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReaderWriter<ReadRequest, ReadResponse>> stream_;
};

TEST_F(ChatTest, TalksInOrderUntilTheClientHasFinished) {
  ReadResponse response;
  for (int i = 0; i < 50; ++i) {
    Send(i);
    ASSERT_TRUE(stream_->Read(&response));
    EXPECT_EQ(response.number(), i);
  }
  stream_->WritesDone();
  EXPECT_FALSE(stream_->Read(&response));
  EXPECT_TRUE(stream_->Finish().ok());
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, TheServerMayFinishFirst) {
  Send(0, "end");
  ReadResponse response;
  EXPECT_FALSE(stream_->Read(&response));
  EXPECT_TRUE(stream_->Finish().ok());
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, ABadMessageEndsIt) {
  Send(std::numeric_limits<double>::infinity());
  EXPECT_EQ(DetailOf(rpc::FromGrpc(stream_->Finish())).field, "number");
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, AFailureOfTheHandlerEndsIt) {
  Send(0, "bad");
  EXPECT_EQ(DetailOf(rpc::FromGrpc(stream_->Finish())).field, "name");
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, TheReaderLearnsThatTheClientIsGone) {
  Send(1);
  ReadResponse response;
  ASSERT_TRUE(stream_->Read(&response));
  context_->TryCancel();
  stream_->Finish();
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, DrainingEndsIt) {
  Send(1);
  ReadResponse response;
  ASSERT_TRUE(stream_->Read(&response));
  std::thread shutdown([this] { host_->Shutdown(); });
  EXPECT_FALSE(stream_->Read(&response));
  const absl::Status status = rpc::FromGrpc(stream_->Finish());
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(DetailOf(status).reason, "SHUTTING_DOWN");
  shutdown.join();
  EXPECT_TRUE(ended_.Wait());
}

}  // namespace
}  // namespace mortise::testing
