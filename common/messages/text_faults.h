// Everything that is wrong with a message that somebody wrote as protobuf text; protobuf's own
// reader tells of the first fault only. Target mortise_message_faults.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace google::protobuf {
class Descriptor;
}

namespace mortise {

struct TextFault {
  int line = 1;    // the first is 1
  int column = 1;  // the first is 1; tabs go on to the next multiple of 8
  std::string message;
};

// Returns the faults of `text` as a message of `type`: fields that there are not or that are there
// twice, values that they do not take, and where the text cannot be understood any further. In
// their order; of very many, the first 40. Takes time in proportion to the text's length.
std::vector<TextFault> TextFaults(std::string_view text, const google::protobuf::Descriptor& type);

}  // namespace mortise
