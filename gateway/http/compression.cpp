#include "gateway/http/compression.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <new>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/http/http_context.h"

namespace mortise::gateway {
namespace {

// Tells zlib that the data has gzip's own header and trailer.
constexpr int kGzipFormat = 16 + MAX_WBITS;
constexpr int kMemoryLevel = 8;  // zlib's default
constexpr std::size_t kCompressionStep = 64 * 1024;

// "q=0" of "gzip;q=0", also as 0.0; other parameters mean nothing here.
bool HasWeightOfZero(absl::string_view parameters) {
  const auto q = parameters.find("q=");
  double weight = 1;
  return q != absl::string_view::npos && absl::SimpleAtod(parameters.substr(q + 2), &weight) &&
         weight <= 0;
}

absl::Status DamagedBody() { return InvalidField("request", "has a body that is no sound gzip"); }

}  // namespace

bool AcceptsGzip(std::string_view accept_encoding) {
  bool any = false;
  std::string all = absl::AsciiStrToLower({accept_encoding.data(), accept_encoding.size()});
  absl::string_view rest = all;
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    const absl::string_view entry = rest.substr(0, comma);
    const auto semicolon = std::min(entry.find(';'), entry.size());
    const absl::string_view coding = absl::StripAsciiWhitespace(entry.substr(0, semicolon));
    const bool wanted = !HasWeightOfZero(entry.substr(semicolon));
    if (coding == "gzip" || coding == "x-gzip") return wanted;
    if (coding == "*") any = wanted;
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return any;
}

bool IsCompressible(std::string_view media_type) {
  constexpr std::array<std::string_view, 8> kTypes = {
      "application/json", "application/xml",  "application/step",         "application/x-protobuf",
      "image/svg",        "application/gltf", "application/octet-stream", "application/javascript"};
  const std::string type = absl::AsciiStrToLower({media_type.data(), media_type.size()});
  if (type.starts_with("text/") || type.starts_with("model/")) return true;
  return std::any_of(kTypes.begin(), kTypes.end(),
                     [&](std::string_view known) { return type.starts_with(known); });
}

struct GzipWriter::Stream {
  Stream() {
    if (deflateInit2(&zlib, Z_BEST_SPEED, Z_DEFLATED, kGzipFormat, kMemoryLevel,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Stream() { deflateEnd(&zlib); }
  z_stream zlib = {};
};

GzipWriter::GzipWriter() : stream_(std::make_unique<Stream>()) {}
GzipWriter::~GzipWriter() = default;

std::string GzipWriter::Add(std::string_view bytes, bool end) {
  z_stream& zlib = stream_->zlib;
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  zlib.avail_in = static_cast<uInt>(bytes.size());
  std::string compressed;
  do {
    const std::size_t before = compressed.size();
    compressed.resize(before + kCompressionStep);
    zlib.next_out = reinterpret_cast<Bytef*>(compressed.data() + before);
    zlib.avail_out = static_cast<uInt>(kCompressionStep);
    deflate(&zlib, end ? Z_FINISH : Z_NO_FLUSH);
    compressed.resize(before + kCompressionStep - zlib.avail_out);
  } while (zlib.avail_out == 0);
  return compressed;
}

struct GzipReader::Stream {
  Stream() {
    if (inflateInit2(&zlib, kGzipFormat) != Z_OK) throw std::bad_alloc();
  }
  ~Stream() { inflateEnd(&zlib); }
  z_stream zlib = {};
  std::string given;
  bool ended = false;
};

GzipReader::GzipReader() : stream_(std::make_unique<Stream>()) {}
GzipReader::~GzipReader() = default;

void GzipReader::Give(std::string bytes) {
  stream_->given = std::move(bytes);
  stream_->zlib.next_in = reinterpret_cast<Bytef*>(stream_->given.data());
  stream_->zlib.avail_in = static_cast<uInt>(stream_->given.size());
}

absl::StatusOr<std::string> GzipReader::Take(std::size_t most) {
  z_stream& zlib = stream_->zlib;
  if (stream_->ended) {
    if (zlib.avail_in > 0) return DamagedBody();
    return std::string();
  }
  std::string expanded(most, '\0');
  zlib.next_out = reinterpret_cast<Bytef*>(expanded.data());
  zlib.avail_out = static_cast<uInt>(most);
  const int result = inflate(&zlib, Z_NO_FLUSH);
  stream_->ended = result == Z_STREAM_END;
  // Z_BUF_ERROR: nothing was left to expand.
  if (result != Z_OK && result != Z_BUF_ERROR && !stream_->ended) return DamagedBody();
  if (stream_->ended && zlib.avail_in > 0) return DamagedBody();
  expanded.resize(most - zlib.avail_out);
  return expanded;
}

bool GzipReader::ended() const { return stream_->ended; }

absl::StatusOr<std::string> ExpandGzip(std::string body, std::size_t limit) {
  GzipReader reader;
  reader.Give(std::move(body));
  std::string whole;
  for (;;) {
    MORTISE_ASSIGN_OR_RETURN(const std::string piece, reader.Take(kCompressionStep));
    if (piece.empty()) break;
    if (whole.size() + piece.size() > limit) {
      return TooLarge("the request's body, expanded,", absl::StrCat(limit, " bytes"));
    }
    whole.append(piece);
  }
  if (!reader.ended()) return DamagedBody();
  return whole;
}

boost::asio::awaitable<bool> WriteCompressed(HttpConnection& connection, const HttpRequest& request,
                                             int status, HeaderList headers, std::string body,
                                             bool keep_alive) {
  headers.emplace_back("vary", "Accept-Encoding");
  if (body.size() > kSmallestCompressed && AcceptsGzip(HeaderOf(request, "accept-encoding"))) {
    headers.emplace_back("content-encoding", "gzip");
    body = GzipWriter().Add(body, true);
  }
  co_return co_await connection.Write(status, headers, std::move(body), keep_alive);
}

}  // namespace mortise::gateway
