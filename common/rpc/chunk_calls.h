// Bytes to and from methods that take or give a stream of mortise.v1.Chunk.
#pragma once

#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/sync_stream.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/types.pb.h"

namespace mortise::rpc {

// Sends all of them, the first chunk with their number and their SHA-256 digest, and says that
// there is no more to come. A receiver that has enough, or refuses, tells by how the call finishes.
inline void SendChunks(const std::string& bytes, grpc::ClientWriter<v1::Chunk>& writer) {
  constexpr std::size_t kChunk = 512 * 1024;
  // Of no bytes one chunk says so.
  for (std::size_t offset = 0; offset == 0 || offset < bytes.size(); offset += kChunk) {
    v1::Chunk chunk;
    chunk.set_offset(static_cast<std::int64_t>(offset));
    chunk.set_data(bytes.substr(offset, kChunk));
    if (offset == 0) {
      chunk.set_total_size(static_cast<std::int64_t>(bytes.size()));
      chunk.set_sha256(Sha256Hex(bytes));
    }
    if (!writer.Write(chunk)) break;
  }
  writer.WritesDone();
}

// Returns all that the call of `context` sends, and finishes it. Fails with `too_large` as soon as
// there are, or are said to be, more than `limit` bytes, and with what the call fails with. Whoever
// knows the digest of the whole checks it.
inline absl::StatusOr<std::string> ReceiveChunks(grpc::ClientContext& context,
                                                 grpc::ClientReader<v1::Chunk>& reader,
                                                 std::int64_t limit,
                                                 const absl::Status& too_large) {
  std::string bytes;
  v1::Chunk chunk;
  while (reader.Read(&chunk)) {
    const auto received = static_cast<std::int64_t>(bytes.size() + chunk.data().size());
    if (chunk.total_size() > limit || received > limit) {
      context.TryCancel();
      while (reader.Read(&chunk)) {
      }
      reader.Finish().IgnoreError();
      return too_large;
    }
    if (bytes.empty()) bytes.reserve(static_cast<std::size_t>(chunk.total_size()));
    bytes += chunk.data();
  }
  MORTISE_RETURN_IF_ERROR(FromGrpc(reader.Finish()));
  return bytes;
}

}  // namespace mortise::rpc
