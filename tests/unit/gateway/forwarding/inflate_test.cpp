// Compressed messages: expanded within the limit, and refused when damaged.
#include "gateway/forwarding/inflate.h"

#include <gmock/gmock.h>
#include <grpcpp/support/byte_buffer.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "common/rpc/server_limits.h"
#include "gateway/forwarding/wire.h"

namespace mortise::gateway {
namespace {

using testing::HasSubstr;

// `megabytes` of zeros, made piece by piece.
std::string Gzip(const std::string& first, int megabytes) {
  z_stream stream = {};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string compressed;
  const auto feed = [&](std::string piece, int flush) {
    stream.next_in = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_in = static_cast<uInt>(piece.size());
    char out[65536];
    do {
      stream.next_out = reinterpret_cast<Bytef*>(out);
      stream.avail_out = sizeof(out);
      deflate(&stream, flush);
      compressed.append(out, sizeof(out) - stream.avail_out);
    } while (stream.avail_out == 0);
  };
  feed(first, Z_NO_FLUSH);
  for (int i = 0; i < megabytes; ++i) feed(std::string(1 << 20, '\0'), Z_NO_FLUSH);
  feed("", Z_FINISH);
  deflateEnd(&stream);
  return compressed;
}

absl::Status Expand(const std::string& bytes, std::string& expanded) {
  grpc::ByteBuffer message = ToByteBuffer(bytes);
  const absl::Status status = Inflate(message).status();
  expanded = ToString(message);
  return status;
}

TEST(Inflate, LeavesPlainMessagesAlone) {
  for (const std::string& plain : {std::string(), std::string("\x1f"),
                                   std::string("\x0a\x03"
                                               "abc"),
                                   std::string("\x0a\x02\x1f\x8b")}) {
    std::string expanded;
    EXPECT_TRUE(Expand(plain, expanded).ok());
    EXPECT_EQ(expanded, plain);
    grpc::ByteBuffer message = ToByteBuffer(plain);
    EXPECT_FALSE(*Inflate(message)) << "was not compressed";
  }
}

TEST(Inflate, ExpandsWhatFits) {
  for (const std::string& text : {std::string(), std::string("hello"), std::string(100000, 'x')}) {
    std::string expanded;
    const absl::Status status = Expand(Gzip(text, 0), expanded);
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_EQ(expanded, text);
  }
  std::string expanded;
  EXPECT_TRUE(Expand(Gzip("", 4), expanded).ok()) << "just the limit";
  EXPECT_EQ(expanded.size(), static_cast<std::size_t>(rpc::kMaxMessageBytes));
}

TEST(Inflate, StopsAtTheLimit) {
  for (const std::string& bomb : {Gzip("x", 4), Gzip("", 400)}) {
    std::string left;
    const absl::Status status = Expand(bomb, left);
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(status.message()), HasSubstr("expanded"));
    EXPECT_EQ(left, bomb) << "nothing is kept";
  }
}

TEST(Inflate, RefusesDamage) {
  const std::string good = Gzip("hello, hello, hello", 0);
  std::string changed = good;
  changed[good.size() - 6] ^= 1;  // of the checksum
  for (const std::string& bad :
       {good.substr(0, 2), good.substr(0, 10), good.substr(0, good.size() - 1), good + "x",
        good + good, changed, std::string("\x1f\x8b and no more"),
        std::string("\x1f\x8b\x08\xff", 4) + std::string(40, 'x')}) {
    std::string left;
    EXPECT_EQ(Expand(bad, left).code(), absl::StatusCode::kInvalidArgument);
  }
}

// Slices end anywhere, also within the two bytes by which it is recognised.
TEST(Inflate, TakesMessagesInPieces) {
  const std::string bytes = Gzip("hello", 0);
  std::vector<grpc::Slice> slices;
  for (const char byte : bytes) slices.emplace_back(&byte, 1);
  grpc::ByteBuffer message(slices.data(), slices.size());
  const absl::StatusOr<bool> compressed = Inflate(message);
  ASSERT_TRUE(compressed.ok()) << compressed.status();
  EXPECT_TRUE(*compressed);
  EXPECT_EQ(ToString(message), "hello");
}

}  // namespace
}  // namespace mortise::gateway
