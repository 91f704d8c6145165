// The commands of the manual, as a reader would copy them from the documents.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace mortise::e2e {

struct ManualCommand {
  int line = 0;      // in the document, from 1
  std::string text;  // continued lines joined, without the comment behind it
};

// A fenced block whose info string begins with "sh".
struct ManualBlock {
  std::string document;  // "docs/gateway.md"
  std::string mark;      // what stands behind "sh": "", "not-run", "costly", "secure-house"
  std::string text;      // as it stands there
  std::vector<ManualCommand> commands;

  // "docs/gateway.md:12", for messages.
  std::string Place(const ManualCommand& command) const;
};

// The shell blocks of a document under the source folder, in order.
std::vector<ManualBlock> ReadManual(const std::string& document);

// README.md and every page in docs/.
std::vector<std::string> ManualDocuments();

// Puts what is real in the place of what stands for it in the manual: plans/0198c1, fronts/0198c1,
// maps/0198c1 and workOrders/0198c1 are the last such names that a command printed, and the usual
// addresses 127.0.0.1:7700 and 127.0.0.1:7780 are those of the house on `state`.
class StandIns {
 public:
  explicit StandIns(const std::filesystem::path& state);

  void Learn(const std::string& printed);
  std::string Replace(std::string text) const;

 private:
  std::map<std::string, std::string> real_;  // by what stands for it
};

}  // namespace mortise::e2e
