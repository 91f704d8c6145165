// Bodies in gzip, both ways, piece by piece.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "gateway/http/http_connection.h"

namespace mortise::gateway {

// Answers up to this are sent as they are: their headers cost more than is saved.
inline constexpr std::size_t kSmallestCompressed = 1024;

// Whether the client takes gzip: `Accept-Encoding` names it, or "*", without a weight of 0.
bool AcceptsGzip(std::string_view accept_encoding);

// Whether compressing files of this media type gains anything: text, JSON, CSV, STEP, glTF, meshes.
bool IsCompressible(std::string_view media_type);

// Compresses one body. Quick rather than small: it runs on a thread that serves others, too.
class GzipWriter {
 public:
  GzipWriter();
  ~GzipWriter();
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  // Returns what there is to send after these bytes, which may be nothing yet; at the end, after
  // the last ones, all that is left.
  std::string Add(std::string_view bytes, bool end);

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

// Expands one body.
class GzipReader {
 public:
  GzipReader();
  ~GzipReader();
  GzipReader(const GzipReader&) = delete;
  GzipReader& operator=(const GzipReader&) = delete;

  // Takes the next compressed bytes. All of them must have been expanded before.
  void Give(std::string bytes);

  // Returns at most `most` more bytes of what was given, expanded; empty if it takes more for that.
  // INVALID_ARGUMENT naming `request` for what is not gzip, is damaged, or goes on behind its end.
  absl::StatusOr<std::string> Take(std::size_t most);

  // Whether the compressed body has come to its end.
  bool ended() const;

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

// Returns a whole body, expanded. RESOURCE_EXHAUSTED, TOO_LARGE as soon as it is over `limit`, and
// no more than that is ever held; INVALID_ARGUMENT as GzipReader, and for one cut short.
absl::StatusOr<std::string> ExpandGzip(std::string body, std::size_t limit);

// Sends a whole answer in gzip where the request accepts it and `body` is large enough. `headers`
// have its content type. False if the client is gone.
boost::asio::awaitable<bool> WriteCompressed(HttpConnection& connection, const HttpRequest& request,
                                             int status, HeaderList headers, std::string body,
                                             bool keep_alive);

}  // namespace mortise::gateway
