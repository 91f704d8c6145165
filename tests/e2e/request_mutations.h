// Bad requests made from good ones: what is wrong with each, and how it should be answered.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace google::protobuf {
class Descriptor;
class Message;
}  // namespace google::protobuf

namespace mortise::e2e {

// How a request should be answered.
enum class Verdict {
  kUnreadable,  // INVALID_ARGUMENT: not a message of the type
  kPath,        // INVALID_ARGUMENT naming exactly `path`
  kField,       // INVALID_ARGUMENT or OUT_OF_RANGE naming a field that has `path`'s last name in it
  kTooLarge,    // RESOURCE_EXHAUSTED
  kRefused,     // with any failure that is the caller's
  kAnswered,    // well, or with any failure that is the caller's
};

struct BadRequest {
  std::string what;  // for people
  std::string path;  // the field: "item.dimensions[0].size"
  Verdict verdict = Verdict::kAnswered;
  std::string bytes;
};

// `count` pseudo-random byte strings of 0 to 400 bytes; the same for the same seed. Those that are
// messages of `type` by chance are left out.
std::vector<BadRequest> RandomBytes(const google::protobuf::Message& type, unsigned seed,
                                    int count);

// `good` cut off at up to `count` places where what remains is no message.
std::vector<BadRequest> Truncations(const google::protobuf::Message& good, int count);

// `good` with each field that can be reached in its type, set or not, spoilt in each way that its
// type and name suggest.
std::vector<BadRequest> SpoiltFields(const google::protobuf::Message& good);

// `good` with each number that need not be whole, set or not, large in turn: 30e3, as of
// millimetres for metres, and 1e300. Each has a request id of its own. They may be answered well.
std::vector<BadRequest> LargeNumbers(const google::protobuf::Message& good);

}  // namespace mortise::e2e
