// The rule that every List method of the house keeps: how many entries a page has, how many bytes,
// and how a request for one that cannot be is refused.
//
// A page ends after as many entries as were asked for, or before the entry with which it would
// outgrow kMaxPageBytes, whichever comes first. A single entry that is larger than that is a page
// of its own. A page that is not the last has a token, also where it is shorter than was asked.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::resources {

inline constexpr int kDefaultPageSize = 100;  // entries, where a request says 0
inline constexpr int kMaxPageSize = 1000;     // entries

// Of a page's entries. gRPC's clients take 4 MiB, the same entries as JSON are longer, and one
// entry more must fit where it is the only one.
inline constexpr std::size_t kMaxPageBytes = 2'000'000;

// What a request asks for, as handlers see it (their page tokens are positions: page_tokens.h).
struct PageQuery {
  int size = kDefaultPageSize;
  std::string after;  // where the page before ended; empty for the first page
};

// INVALID_ARGUMENT naming page_size that is below 0 or above kMaxPageSize, and page_token that
// is no position of any list: too long, or with characters that no key has.
absl::StatusOr<PageQuery> ReadPageQuery(int page_size, const std::string& page_token);

// The same of a List method's request.
template <typename Request>
absl::StatusOr<PageQuery> ReadPageQuery(const Request& request) {
  return ReadPageQuery(request.page_size(), request.page_token());
}

// The refusal of a page token that this list has not given.
absl::Status NotAPageToken();

// Counts what a page holds.
class PageRoom {
 public:
  // `most` entries at most.
  explicit PageRoom(int most) : most_(most) {}

  // Whether an entry of so many bytes belongs on the page; if it does it is counted.
  bool Take(std::size_t bytes);

 private:
  const int most_;
  int entries_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace mortise::resources
