#include "gateway/forwarding/inflate.h"

#include <grpcpp/support/byte_buffer.h>
#include <zlib.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/server_limits.h"

namespace mortise::gateway {
namespace {

constexpr std::size_t kStep = 64 * 1024;
// Tells zlib that the data has gzip's own header and trailer.
constexpr int kGzip = 16 + MAX_WBITS;

struct InflateEnd {
  void operator()(z_stream* stream) const {
    inflateEnd(stream);
    delete stream;
  }
};
using Stream = std::unique_ptr<z_stream, InflateEnd>;

absl::Status Damaged() { return InvalidField("request", "is compressed, and damaged"); }

bool IsGzip(const std::vector<grpc::Slice>& slices) {
  unsigned char first[2] = {};
  std::size_t found = 0;
  for (const grpc::Slice& slice : slices) {
    for (std::size_t i = 0; i < slice.size() && found < 2; ++i) first[found++] = slice.begin()[i];
  }
  return found == 2 && first[0] == 0x1f && first[1] == 0x8b;
}

// Feeds one slice; `ended` once the compressed data is complete.
absl::Status Feed(z_stream& stream, const grpc::Slice& slice, bool& ended, std::string& expanded) {
  stream.next_in = const_cast<Bytef*>(slice.begin());
  stream.avail_in = static_cast<uInt>(slice.size());
  while (stream.avail_in > 0) {
    if (ended) return Damaged();
    const std::size_t before = expanded.size();
    expanded.resize(before + kStep);
    stream.next_out = reinterpret_cast<Bytef*>(expanded.data() + before);
    stream.avail_out = static_cast<uInt>(kStep);
    const int result = inflate(&stream, Z_NO_FLUSH);
    expanded.resize(before + kStep - stream.avail_out);
    if (expanded.size() > static_cast<std::size_t>(rpc::kMaxMessageBytes)) {
      return TooLarge("the message, expanded,", absl::StrCat(rpc::kMaxMessageBytes, " bytes"));
    }
    ended = result == Z_STREAM_END;
    if (result != Z_OK && !ended) return Damaged();
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<bool> Inflate(grpc::ByteBuffer& message) {
  std::vector<grpc::Slice> slices;
  if (!message.Dump(&slices).ok() || !IsGzip(slices)) return false;
  const Stream stream(new z_stream());
  if (inflateInit2(stream.get(), kGzip) != Z_OK) return absl::InternalError("zlib has no memory");
  bool ended = false;
  std::string expanded;
  for (const grpc::Slice& slice : slices) {
    MORTISE_RETURN_IF_ERROR(Feed(*stream, slice, ended, expanded));
  }
  if (!ended) return Damaged();
  const grpc::Slice plain(expanded.data(), expanded.size());
  message = grpc::ByteBuffer(&plain, 1);
  return true;
}

}  // namespace mortise::gateway
