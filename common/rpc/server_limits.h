// What every gRPC server of the house keeps to, and how it gets its connections.
#pragma once

#include <functional>
#include <memory>

namespace grpc {
class ServerBuilder;
class ServerCredentials;
}  // namespace grpc

namespace mortise::rpc {

inline constexpr int kMaxMessageBytes = 4 * 1024 * 1024;

// Streams of one connection of HTTP/2; what a client begins beyond waits at the client.
inline constexpr int kMaxStreamsOfConnection = 1000;

// What comes before the messages of a call, by HTTP/2's count. Callers' own metadata is limited at
// the gateway, which adds the identity to it.
inline constexpr int kMaxMetadataBytes = 16 * 1024;

// Limits of messages and streams, keep-alive, no decompression: gRPC 1.51 expands a compressed
// message before it looks at the size, so that a megabyte may become a thousand. Compressed calls
// are UNIMPLEMENTED, and say so to clients that ask which compression is accepted.
void SetServerLimits(grpc::ServerBuilder& builder, int most_metadata = kMaxMetadataBytes);

// The server will serve the connected sockets that the function is given, with these credentials.
// Once it is started.
std::function<void(int descriptor)> TakesConnections(
    grpc::ServerBuilder& builder, std::shared_ptr<grpc::ServerCredentials> credentials);

}  // namespace mortise::rpc
