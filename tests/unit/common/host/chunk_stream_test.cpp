// Files in chunks through a real server.
#include "common/host/chunk_stream.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "tests/unit/common/host/stream_fixture.h"

namespace mortise::testing {
namespace {

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

}  // namespace
}  // namespace mortise::testing
