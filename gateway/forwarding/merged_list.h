// One list out of the lists of several services, page by page, in one order.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/resources/page_rule.h"

namespace mortise::gateway {

// How far one source has been read: its page token, how many items of that page are used up, and
// the identity of the last of these. Items that a source gets afterwards stand before it, so that
// the count is only where to look for it.
struct SourcePosition {
  std::string token;
  int skip = 0;
  std::string last;  // empty if none of the page is used up
};

// By source; sources that are read to their end are absent.
using MergePosition = std::map<std::string, SourcePosition>;

// Returns the page token of a merged list. Empty text stands for the beginning: every source of
// `sources` at its first page. INVALID_ARGUMENT naming page_token for text that is not a token, or
// names other sources.
absl::StatusOr<MergePosition> ParseMergeToken(std::string_view text,
                                              const std::vector<std::string>& sources);
std::string FormatMergeToken(const MergePosition& position);

template <class Item>
struct ListPage {
  std::vector<Item> items;
  std::string next_page_token;  // empty on the last page
};

// A page of one source, of which some is used up.
template <class Item>
struct SourceRead {
  std::string name;
  ListPage<Item> page;
  SourcePosition position;
  std::size_t used = 0;
  bool found_last = true;  // else all of the page came in front of what was used up
  std::string given = {};  // identity of the last item given of it; empty if there is none
};

// Returns the page of a source that `position` is on, used up to where that says.
template <class Item, class Fetch, class Identify>
absl::StatusOr<SourceRead<Item>> ReadSource(const std::string& name, const SourcePosition& position,
                                            int page_size, const Fetch& fetch,
                                            const Identify& identify) {
  SourceRead<Item> read{name, {}, position};
  // Sources bound their pages as this list does; what they cannot give makes this page shorter.
  const int asked = std::min(page_size + position.skip, resources::kMaxPageSize);
  MORTISE_ASSIGN_OR_RETURN(read.page, fetch(name, asked, position.token));
  if (position.last.empty()) return read;
  const auto& items = read.page.items;
  const auto last = std::find_if(items.begin(), items.end(),
                                 [&](const Item& item) { return identify(item) == position.last; });
  read.found_last = last != items.end();
  read.used = static_cast<std::size_t>(last - items.begin()) + (read.found_last ? 1 : 0);
  return read;
}

// Returns the one whose next item comes first of all; null at the end of all pages, and where one
// is used up that has a next page: what is on that might come first.
template <class Item, class Before>
SourceRead<Item>* FindFirst(std::vector<SourceRead<Item>>& reads, const Before& before) {
  SourceRead<Item>* best = nullptr;
  for (SourceRead<Item>& read : reads) {
    if (read.used == read.page.items.size()) {
      if (!read.page.next_page_token.empty()) return nullptr;
    } else if (best == nullptr ||
               before(read.page.items[read.used], best->page.items[best->used])) {
      best = &read;
    }
  }
  return best;
}

// Returns where the next page begins.
template <class Item>
MergePosition PositionAfter(const std::vector<SourceRead<Item>>& reads) {
  MergePosition next;
  for (const SourceRead<Item>& read : reads) {
    const std::string& reached = read.given.empty() ? read.position.last : read.given;
    if (read.used < read.page.items.size()) {
      next[read.name] = {read.position.token, static_cast<int>(read.used), reached};
    } else if (!read.page.next_page_token.empty()) {
      next[read.name] = {read.page.next_page_token, 0, read.found_last ? "" : reached};
    }
  }
  return next;
}

// Returns the next page of the merged list. `fetch(source, page_size, page_token)` gives a page of
// a source, whose items are in the order of `before(a, b)`; failures end it. `identify(item)` gives
// a text that no other item of its source has, not empty, and that stays the same; `size_of(item)`
// its bytes, for the page to end where all pages do (common/resources/page_rule.h). Items of one
// source keep their order, and none is lost or repeated between pages, also where a source gets new
// items at its front meanwhile: those that would stand before what was given are left out. No item
// may go away while the list is read.
template <class Item, class Fetch, class Before, class Identify, class SizeOf>
absl::StatusOr<ListPage<Item>> MergeLists(const std::vector<std::string>& sources, int page_size,
                                          const std::string& page_token, const Fetch& fetch,
                                          const Before& before, const Identify& identify,
                                          const SizeOf& size_of) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query,
                           resources::ReadPageQuery(page_size, page_token));
  MORTISE_ASSIGN_OR_RETURN(const MergePosition start, ParseMergeToken(page_token, sources));
  std::vector<SourceRead<Item>> reads;
  for (const auto& [name, position] : start) {
    MORTISE_ASSIGN_OR_RETURN(SourceRead<Item> read,
                             ReadSource<Item>(name, position, query.size, fetch, identify));
    reads.push_back(std::move(read));
  }
  ListPage<Item> merged;
  resources::PageRoom room(query.size);
  while (SourceRead<Item>* const first = FindFirst(reads, before)) {
    Item& item = first->page.items[first->used];
    if (!room.Take(size_of(item))) break;
    first->given = identify(item);
    merged.items.push_back(std::move(item));
    ++first->used;
  }
  const MergePosition next = PositionAfter(reads);
  if (!next.empty()) merged.next_page_token = FormatMergeToken(next);
  return merged;
}

}  // namespace mortise::gateway
