// Sends bytes to a method that takes a stream of mortise.v1.Chunk.
#pragma once

#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/sync_stream.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/digest.h"
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

}  // namespace mortise::rpc
