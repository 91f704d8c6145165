// What HTTP says of files that a client has already, wholly or in part (RFC 9110, 13 and 14).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mortise::gateway {

// Bytes of a file, `first` to `last`, both included.
struct ByteRange {
  int64_t first = 0;
  int64_t last = 0;

  int64_t size() const { return last - first + 1; }
};

// What is sent of a file.
struct RangeChoice {
  bool satisfiable = true;         // false: 416, the file has none of what is wanted
  std::optional<ByteRange> range;  // nothing: the whole file
};

// Returns what the value of `Range` asks for of a file of `size` bytes: "bytes=0-99", "bytes=100-"
// or "bytes=-100". The whole file for an empty value, other units, several ranges and what cannot
// be read, as servers may; an end behind that of the file is the file's.
RangeChoice ChooseRange(std::string_view range, int64_t size);

// Whether `If-None-Match`, which names tags or "*", names `tag`, a strong tag with its quotes. Weak
// ones count as the strong.
bool NamesTag(std::string_view if_none_match, std::string_view tag);

// Whether a range may be answered under this `If-Range`, which names `tag` exactly or is absent. A
// date never does, as files here have none.
bool AllowsRange(std::string_view if_range, std::string_view tag);

// Returns the value of `Content-Disposition` that has a file saved under `file_name`: its own name
// where that is plain, and in any case one without separators of paths, quotes and control
// characters.
std::string AttachmentNamed(std::string_view file_name);

// Returns `media_type` if it is a type and subtype with plain parameters,
// "application/octet-stream" otherwise: what a service says must not become another header.
std::string SafeMediaType(std::string_view media_type);

}  // namespace mortise::gateway
